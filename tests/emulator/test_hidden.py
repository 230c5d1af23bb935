"""One battery over all hidden effects: a new file in hidden/ is in it by itself."""

import functools
import json

import numpy as np
import pytest

from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.emulator.hidden import effects
from spirob.emulator.machine import Machine
from spirob.errors import ConfigError
from spirob.trials import Trial
from tests.emulator.conftest import hinge_angles, play
from tests.emulator.visibility import (
    Recorded,
    in_current,
    in_displacement,
    record,
    record_over_bus,
)

EFFECTS = [name for name in effects() if name != "none"]
NOTICED = 0.01  # share of a current
TRACE = 1e-3
STRONG = 2.0
BOUNDED = {"feedback_latency": 1.3}  # later frames would make the controller ring


def bend(side: str) -> Trial:
    """Curl, hold and uncurl by one tendon against the other, within two seconds."""
    other = {"left": "right", "right": "left"}[side]
    moves = [[0.2, 0.0], [1.0, 0.06], [0.1, 0.06], [0.6, 0.03]]
    pull = {"mode": "displacement", "profile": {"kind": "moves", "waypoints": moves}}
    hold = {"mode": "current", "profile": {"kind": "constant", "value": 0.25, "blend": 0.3}}
    motors = {side: pull | {"current_limit": 5.0}, other: hold | {"current_limit": 5.0}}
    plain = {"name": f"bend_{side}", "role": "train", "duration": 1.9, "motors": motors}
    return Trial.from_plain(plain)


@functools.cache
def twin(side: str) -> Recorded:
    return record(bend(side), "none")


def seen(effect: str, strength: float, side: str) -> float:
    """How much the logs change, as a share of a current; a millimetre counts as a tenth."""
    one = record(bend(side), effect, strength)
    assert all(np.isfinite(values).all() for values in vars(one).values())
    length = in_displacement(one, twin(side)).max() / 1e-3
    return max(in_current(one, twin(side)).max(), 0.1 * length)


def numbers(effect: str, strength: float = 1.0, seed: int = 1) -> np.ndarray:
    return Machine(EmulatedRig(), HiddenSettings(effect, strength), seed).numbers


def test_there_are_kinds_for_every_part_of_the_machine():
    assert len(EFFECTS) >= 18


@pytest.mark.parametrize("effect", EFFECTS)
def test_a_trace_is_hardly_seen_and_the_stronger_the_more(effect):
    strengths = TRACE, 1.0, BOUNDED.get(effect, STRONG)
    trace, typical, strong = (seen(effect, s, "left") for s in strengths)
    assert trace < 0.5 * NOTICED
    assert NOTICED < typical < strong


@pytest.mark.parametrize("effect", EFFECTS)
def test_effect_is_seen_from_the_other_side_too(effect):
    assert seen(effect, 1.0, "right") > NOTICED


@pytest.mark.parametrize("effect", EFFECTS)
def test_driven_hard_it_stays_finite_and_within_its_stops(machine, effect):
    made = machine(effect, strength=3.0, clean=False)
    for currents in ((5.0, 0.0), (5.0, 5.0), (-5.0, 5.0), (0.0, 0.0)):
        play(made, currents, 120)
        assert np.rad2deg(np.abs(hinge_angles(made))).max() < 16.0


@pytest.mark.parametrize("effect", EFFECTS)
def test_strength_zero_is_the_machine_without_to_the_last_bit(effect):
    assert numbers(effect, 0.0).tobytes() == numbers("none").tobytes()
    assert numbers(effect).tobytes() != numbers("none").tobytes()


@pytest.mark.parametrize("effect", EFFECTS)
def test_details_come_from_the_seed(effect):
    first, again, other = (
        Machine(EmulatedRig(), HiddenSettings(effect), seed).hidden[0].plain for seed in (3, 3, 4)
    )
    assert first == again
    assert first != other


def test_same_seed_same_log_with_two_effects_with_the_bus_and_without():
    trial, effect = bend("left"), "cogging+feedback_latency:0.5"
    first, again, over_bus = (r(trial, effect) for r in (record, record, record_over_bus))
    for other in (again, over_bus):
        for name, values in vars(first).items():
            assert np.array_equal(values, getattr(other, name)), name


def test_an_effect_is_the_same_in_company_as_alone():
    both = Machine(EmulatedRig(), HiddenSettings("joint_creep:0.5+cogging", 2.0), 7).hidden
    alone = [
        Machine(EmulatedRig(), HiddenSettings(kind, strength), 7).hidden[0]
        for kind, strength in (("joint_creep", 1.0), ("cogging", 2.0))
    ]
    assert [one.plain for one in both] == [one.plain for one in alone]


def test_two_effects_on_the_same_number_add():
    plain, offset, gain, both = (
        numbers(effect)["sensor_gain"]
        for effect in ("none", "current_offset", "current_gain", "current_offset+current_gain")
    )
    np.testing.assert_allclose(both - plain, (offset - plain) + (gain - plain), rtol=1e-12)


def test_truth_tells_both_effects_in_plain_data():
    robot = EmulatedRobot(EmulatedRig(), HiddenSettings("guide_friction:0.5+mount_tilt", 2.0), 1)
    truth = json.loads(json.dumps(robot.truth()))
    robot.close()
    assert truth["effect"] == "guide_friction:0.5+mount_tilt"
    said = [(one["kind"], one["strength"]) for one in truth["hidden"]]
    assert said == [("guide_friction", 1.0), ("mount_tilt", 2.0)]
    assert np.hypot(*truth["hidden"][1]["numbers"]["gravity"]) > 1.0


@pytest.mark.parametrize(
    ("effect", "message"),
    [
        ("cogging+gremlins", "no hidden effect 'gremlins'; known: asymmetric_viscous"),
        ("cogging+cogging:0.5", "'cogging' stands twice"),
        ("none+cogging", "'none' stands beside others"),
        ("cogging+", "'' in 'cogging\\+' is not a kind"),
        ("cogging:strong", "'cogging:strong' in 'cogging:strong' is not a kind"),
        ("cogging:", "'cogging:' in 'cogging:' is not a kind"),
        ("cogging:-1", "strength = -1.0 is out of range"),
        ("cogging:inf", "strength = inf is out of range"),
    ],
)
def test_wrong_settings_are_told_in_a_sentence(effect, message):
    with pytest.raises(ConfigError, match=message):
        numbers(effect)
