"""Shaft and play on a plain axis: sound as effects, and right where theory gives the answer."""

import numpy as np
import pytest

from spirob.effects import all_effects
from spirob.effects.check import check
from spirob.effects.replay import run
from spirob.machine.description.rig import RigFile
from spirob.machine.laws import AXIS, FRICTION, LEVER, LOAD_SIDE, LOSSES, TURNED, for_axis
from spirob.machine.laws.backlash import Backlash
from spirob.machine.laws.direction_dependent_efficiency import OfDescribedLoad
from spirob.machine.laws.gear_compliance import GearCompliance
from spirob.machine.search.preparation import applicable
from tests.machine.rigs import description

DT = 1e-3
PIPED = {"winch.efficiency": ["upstream"], "motor.torque": []}


LAWS = [*AXIS.values(), *LEVER.values(), *FRICTION.values(), *LOAD_SIDE.values(), *LOSSES.values()]
LAWS.append(OfDescribedLoad)


@pytest.mark.parametrize("law", LAWS, ids=[f"{law.__module__}.{law.__name__}" for law in LAWS])
def test_a_law_keeps_what_every_effect_promises(law):
    assert [f"{f.law}: {f.sentence}" for f in check(law)] == []


def test_a_load_on_a_spring_answers_as_an_oscillator_does():
    numbers = {"load_inertia": 0.02, "frequency": 6.0, "damping": 0.2}
    w, own = 2 * np.pi * 3.0, 2 * np.pi * 6.0
    t = np.arange(0, 6, DT)
    torque, _ = run(GearCompliance, numbers, {"speed": np.cos(w * t)}, DT)
    # ω' = Re(i·w·e^(iwt)), φ = ω'/(Ω² - w² + 2i·D·Ω·w), τ = -J·w²·φ
    answer = -0.02 * w**2 * 1j * w / (own**2 - w**2 + 2j * 0.2 * own * w)
    late = t > 3
    expected = np.real(answer * np.exp(1j * w * t))
    np.testing.assert_allclose(torque[late], expected[late], atol=0.01 * abs(answer))


def test_a_loose_load_flies_through_its_play_and_gives_back_its_momentum():
    numbers = {"load_inertia": 0.02, "play": 0.1, "coasting": 10.0, "frequency": 40.0}
    step = DT / 10  # a blow lasts some milliseconds
    t = np.arange(0, 1.5, step)
    speed = np.where(t < 0.5, 2.0 * t, 1.0 - 4.0 * (t - 0.5))  # then 4 rad/s² of braking
    torque, states = run(Backlash, numbers, {"speed": speed}, step)
    flight = np.sqrt(2 * 0.1 / 4.0)  # b = d·T²/2
    loose = (t > 0.51) & (t < 0.49 + flight)
    assert torque[loose] == pytest.approx(-0.02 * 4.0, rel=0.1)
    taken = 0.02 * 4.0 * flight  # of momentum in flight, which the blow gives back
    assert abs(step * torque[t > 0.5].sum()) < 0.05 * taken
    assert states["behind"][-1] == pytest.approx(-0.05, abs=2e-3)  # on the other flank


@pytest.mark.parametrize("step", [1e-3, 1 / 30, 0.05])
def test_play_stays_finite_in_a_log_of_any_rate(step):
    t = np.arange(0, 100, step)
    speed = np.sin(2.0 * t) + 0.3 * np.sin(5.0 * t)
    for coasting, frequency in ((0.01, 8.0), (0.01, 120.0), (10.0, 8.0)):
        numbers = {"load_inertia": 1.0, "play": 1e-3, "coasting": coasting, "frequency": frequency}
        torque, _ = run(Backlash, numbers, {"speed": speed}, step)
        assert np.isfinite(torque).all()


def test_they_take_the_place_of_the_laws_of_a_tendon():
    laws = for_axis(all_effects().values())
    assert {e for e in laws if e.name() in AXIS} == set(AXIS.values())
    possible, _ = applicable(laws, RigFile.model_validate(description()), False, 0.0, True)
    assert set(AXIS.values()) <= set(possible)


def test_what_turns_ahead_of_a_gear_rubs_on_no_teeth():
    signals = {"speed": np.ones(3), "rest_speed": np.full(3, 1e-3)}
    signals |= {"load": np.array([1.0, 0.4, -0.6]), "inertia_torque": np.full(3, 0.8)}
    numbers = {"loss_ratio": 0.1, "softness": 1.0, "rotor_share": 0.5, "presliding": 1e-5}
    torque, _ = run(LOSSES["load_dependent_friction"], numbers, signals, DT)
    np.testing.assert_allclose(torque, [-0.06, 0.0, -0.1], atol=1e-12)


@pytest.mark.parametrize("name", LOSSES)
def test_losses_by_load_turn_round_over_their_way(name):
    law, way, step = LOSSES[name], 0.3, 1e-4
    turned = 2.0 * np.arange(1, 10_001) * step  # rad after a reversal, at 2 rad/s
    speed = np.concatenate([np.full(100_000, -2.0), np.full(10_000, 2.0)])
    signals = {"speed": speed, "rest_speed": 1e-3, "load": 1.0, "inertia_torque": 0.0}
    signals |= {"upstream": 1.0, "current": 1.0}
    signals = {n: np.broadcast_to(signals[n], len(speed)) for n in (*law.reads, *PIPED[law.port])}
    numbers = {n: about.nominal for n, about in law.parameters().items()} | {"presliding": way}
    strength = next(iter(law.neutral))
    out, _ = run(law, numbers | {strength: 0.4}, signals, step)
    mobilised = 1.0 - 2.0 * np.exp(-turned / way)
    expected = {
        "load_dependent_friction": -0.4 * mobilised,
        "direction_dependent_efficiency": 1.0 + 0.2 * (1.0 - mobilised),
    }
    np.testing.assert_allclose(out[100_000:], expected[name], atol=1e-9)


def test_the_share_is_fitted_only_where_a_load_may_hold_some_of_the_motor_s_inertia():
    library = [all_effects()["load_dependent_friction"]]
    for shared in (True, False):
        (law,) = for_axis(library, shared=shared)
        assert law.name() == "load_dependent_friction"
        assert ("rotor_share" in law.fitted()) is shared


def test_what_is_lost_while_a_motor_drives_is_told_of_a_described_load_alone():
    library = [all_effects()["direction_dependent_efficiency"]]
    (law,), (told,) = for_axis(library), for_axis(library, shared=False, given=True)
    assert told is OfDescribedLoad
    assert "forward_loss" not in law.parameters()
    numbers = {"back_excess": 0.4, "softness": 1.0, "presliding": 1e-5, "forward_loss": 0.1}
    signals = {"speed": np.array([1.0, -1.0, -1.0, 1.0]), "rest_speed": np.full(4, 1e-3)}
    signals |= {"upstream": np.ones(4), "current": np.array([1.0, 1.0, -1.0, -1.0])}
    passed, _ = run(told, numbers, signals, DT)
    np.testing.assert_allclose(passed, [0.9, 1.4, 0.9, 1.4], atol=1e-9)


def test_a_rig_without_inertia_has_no_load_to_leave_behind():
    rig = description(known={"inertia": 0.0}, fit={"viscous": description()["fit"]["viscous"]})
    _, excluded = applicable(list(AXIS.values()), RigFile.model_validate(rig), False, 0.0, True)
    assert set(excluded) == set(AXIS)


def test_a_weight_on_a_lever_is_a_pendulum_s():
    angle = np.linspace(-3.0, 3.0, 301)
    numbers = {"sine": 0.5 * np.cos(0.3), "cosine": 0.5 * np.sin(0.3)}
    torque, _ = run(LEVER["tip_payload"], numbers, {"angle": angle}, DT)
    np.testing.assert_allclose(torque, -0.5 * np.sin(angle + 0.3), atol=1e-12)


def test_a_weight_is_asked_for_only_where_an_axis_turns_and_nothing_describes_its_body():
    library = all_effects().values()
    slides, turns = for_axis(library), for_axis(library, TURNED)
    assert not set(LEVER.values()) & set(slides)
    assert not set(LEVER.values()) & set(for_axis(library, 0.9 * TURNED))
    assert set(LEVER.values()) <= set(turns)
    possible, _ = applicable(turns, RigFile.model_validate(description()), False, 0.0, True)
    assert set(LEVER.values()) <= set(possible)
