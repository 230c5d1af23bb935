"""Each law catches the effect that breaks it: a battery that cannot fail would prove nothing."""

import math
import re

import pytest

from spirob.effects import Effect
from spirob.effects.check import LAWS, check
from spirob.parameter import bounded
from spirob.plant.check import check_in_model, compiled


class Sound(Effect):
    """The effect that every broken one is made from."""

    port = "motor.torque"
    reads = {"speed": "motor.speed", "rest_speed": "motor.rest_speed"}
    neutral = {"torque": 0.0}
    traits = {"dissipative", "odd_in_speed"}
    equation = "-T*tanh(speed/rest_speed)"
    title = "friction"
    signature = "It flips its sign."
    explanation = "It rubs."
    tell_apart = {"stribeck_friction": "a slow crawl"}
    needs = "motion"
    references = ("a book",)

    torque: float = bounded(0.002, 0.0, 0.05, "N·m", "T", "level")

    @staticmethod
    def kernel(speed, rest_speed, torque):
        """Torque [N·m]."""
        return -torque * math.tanh(speed / rest_speed)


def with_kernel(function, **changes):
    """The sound effect with another kernel or other declarations; numbers stay as they are."""
    function.__doc__ = "Torque [N·m]."
    number = bounded(0.002, 0.0, 0.05, "N·m", "T", "level")
    body = {n: v for n, v in vars(Sound).items() if n in DECLARED}
    body |= {"kernel": staticmethod(function), "torque": number, "__annotations__": {}}
    body["__annotations__"]["torque"] = float
    return type("Broken", (Effect,), {**body, "__module__": __name__, **changes})


DECLARED = {"port", "reads", "neutral", "traits", "equation", "title", "signature", "explanation"}
DECLARED |= {"tell_apart", "needs", "references"}


def friction(speed, rest_speed, torque):
    return -torque * math.tanh(speed / rest_speed)


def turned(speed, rest_speed, torque):
    return torque * math.tanh(speed / rest_speed)


def leftover(speed, rest_speed, torque):
    return -torque * math.tanh(speed / rest_speed) - 1e-15 * speed


def singular(speed, rest_speed, torque):
    return -torque * speed / abs(speed) * math.tanh(abs(speed) / rest_speed)


def scaled(speed, rest_speed, torque):
    return -torque * math.tanh(speed / 2.0)


def idle(speed, rest_speed, torque):
    return -0.002 * math.tanh(speed / rest_speed) if torque > 0.0 else 0.0


def running_away(speed, rest_speed, way, torque, dt):
    way = way + abs(speed) * dt
    return -torque * way, way


def explicit(speed, rest_speed, way, torque, dt):
    way = way + (speed / rest_speed - way) * dt / 0.01
    return -torque * way, way


def overflowing(speed, rest_speed, torque):
    return -torque * math.tanh(speed / rest_speed) * (int(abs(speed)) + 9223372036854775807)


def faint(speed, rest_speed, torque):
    return -1e-9 * torque * math.tanh(speed / rest_speed)


def laws(effect):
    return {finding.law for finding in check(effect)}


def test_the_sound_effect_breaks_nothing():
    assert check(Sound) == []
    assert check(with_kernel(friction)) == []


@pytest.mark.parametrize(
    ("law", "effect"),
    [
        ("equation", with_kernel(turned)),
        ("equation", with_kernel(friction, equation="-T*tanh(spede/rest_speed)")),
        ("traits", with_kernel(turned)),
        ("neutral", with_kernel(leftover)),
        ("finite", with_kernel(singular)),
        ("units", with_kernel(scaled)),
        ("recovery", with_kernel(idle)),
        ("bounded", with_kernel(running_away, state={"way": 0.0})),
        (
            "evolution",
            with_kernel(
                explicit, state={"way": 0.0}, evolution={"way": "(speed/rest_speed - way)/0.01"}
            ),
        ),
        (
            "evolution",
            with_kernel(explicit, state={"way": 0.0}, evolution={"way": "speed/rest_speed - way"}),
        ),
        ("texts", with_kernel(friction, tell_apart={"no_such_effect": "an experiment"})),
        ("texts", with_kernel(friction, tell_apart={})),
        ("texts", with_kernel(friction, tell_apart={"stribeck_friction": ""})),
        ("texts", with_kernel(friction, references=())),
        ("texts", with_kernel(friction, needs="")),
        ("texts", with_kernel(friction, signature="no full stop")),
    ],
)
def test_a_law_catches_what_breaks_it(law, effect):
    assert law in laws(effect)


@pytest.mark.parametrize("trait", ["even_in_speed", "rate_independent", "constant"])
def test_a_false_claim_is_caught(trait):
    assert "traits" in laws(with_kernel(friction, traits={trait}))


def test_what_depends_on_the_rate_is_told_with_its_size():
    claimed = with_kernel(friction, traits={"rate_independent"})
    (said,) = [finding.sentence for finding in check(claimed) if finding.law == "traits"]
    told = re.search(r"differs by (\S+) N·m, (\S+) of its size$", said)
    gap, share = map(float, told.groups())
    assert 0.0 < gap / share < 1.0, "N·m of a friction"
    assert 1e-9 < share < 2.0


def test_what_drives_the_motion_is_not_dissipative():
    assert "traits" in laws(with_kernel(turned, traits={"dissipative"}, equation=""))


def test_every_law_has_an_effect_that_breaks_it():
    marks = test_a_law_catches_what_breaks_it.pytestmark[0].args[1]
    assert {law for law, _ in marks} == set(LAWS)


def test_a_kernel_that_differs_when_compiled_is_caught():
    assert list(compiled(with_kernel(overflowing)))


def test_an_effect_that_no_reading_shows_is_caught():
    assert "seen" in {finding.law for finding in check_in_model(with_kernel(faint))}
