"""The inverse model: the library's kernels over measured signals, in the rig's size and unit."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis.orders import peaks
from spirob.effects import all_effects
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.body import RigidBody
from spirob.machine.inverse.kernel_loop import Cache, loop_of
from spirob.machine.inverse.motion import late
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes, dimensions, parameters
from spirob.machine.inverse.shapes import counts_periods, shaping
from spirob.machine.laws import for_axis, load_side
from spirob.machine.recordings.filtering import rates
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.preparation import applicable
from tests.machine.rigs import PENDULUM, description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
LIBRARY = all_effects()


def log():
    t = np.arange(0, 6, 2e-3)
    q = np.sin(2 * np.pi * 0.7 * t) + 0.4 * np.sin(2 * np.pi * 1.3 * t + 1)
    return {"t": t, "q": q, "u": np.cos(t) + 0.1 * np.sin(20 * t)}


def problem(*names, **changes):
    rig = RigFile.model_validate(description(**changes))
    effects = [LIBRARY[name] for name in names]
    return InverseProblem(rig, None, [prepare("log", log(), rig)], effects, SIZES, 0.02)


def test_the_bare_model_is_inertia_and_friction():
    made = problem()
    signals = made.signals()
    effort = made({"rig.inertia": 0.03, "rig.viscous": 0.2}) + made.measured()
    expected = 0.03 * signals["acceleration"] + 0.2 * signals["speed"]
    np.testing.assert_allclose(effort, expected, atol=2e-3 * np.abs(expected).max())


def test_effects_at_their_neutral_numbers_change_nothing():
    rig = RigFile.model_validate(description())
    possible, _ = applicable(list(LIBRARY.values()), rig, False, 0.0, True)
    names = [e.name() for e in possible]
    at = {"rig.inertia": 0.03, "rig.viscous": 0.2}
    np.testing.assert_array_equal(problem(*names)(at), problem()(at))


def test_a_torque_of_the_library_is_what_the_drive_has_to_add():
    made = problem("quadratic_drag")
    speed = made.signals()["speed"]
    bare = made({"rig.inertia": 0.0, "rig.viscous": 0.0})
    added = made({"rig.inertia": 0.0, "rig.viscous": 0.0, "quadratic_drag.drag": 0.05}) - bare
    np.testing.assert_allclose(added, 0.05 * speed * np.abs(speed), atol=0.02)


@pytest.mark.parametrize(
    ("name", "number", "value"),
    [
        ("torque_constant_saturation", "saturation", 0.02),
        ("torque_ripple", "sine", 0.2),
        ("direction_dependent_efficiency", "back_excess", 0.3),
        ("direction_dependent_efficiency", "back_excess", 0.65),
        ("driver_dead_band", "dead_band", 0.1),
    ],
)
def test_what_lies_between_effort_and_torque_is_solved_for(name, number, value):
    """The effort found, sent forward through the kernel, gives the torque that was asked for."""
    made = problem(name)
    p = made.table.vector({f"{name}.{number}": value})
    asked, motion = made.asked, made.asked.motion
    wanted = 0.5 * motion.v
    signals = asked.signals(motion, wanted, p)
    effort = asked.through(wanted, p, motion, signals)
    effect = LIBRARY[name]
    share = effect.port == "winch.efficiency"
    above = np.ones_like(effort) if share else effort
    out = asked.run(effect, p, motion, {**signals, "motor.current": effort}, above)
    reached = out * effort if share else out
    np.testing.assert_allclose(reached, wanted, atol=1e-9 * np.abs(wanted).max())


@pytest.mark.parametrize(
    "names",
    [
        ("torque_constant_saturation", "current_gain"),
        ("driver_dead_band", "current_offset"),
        ("winding_heating", "direction_dependent_efficiency"),
        ("torque_ripple",),
    ],
)
def test_about_the_effort_that_a_machine_takes_nothing_is_missed(names):
    """Also behind a reading that is a gain or an offset off."""
    made = problem(*names)
    at = {"rig.inertia": 0.03, "rig.viscous": 0.2}
    at |= {f"{e}.{f}": p.nominal for e in names for f, p in LIBRARY[e].parameters().items()}
    taken = {**log(), "u": made.asked.effort(made.table.vector(at))}
    rig, effects = made.rig, [LIBRARY[name] for name in names]
    again = InverseProblem(rig, None, [prepare("log", taken, rig)], effects, SIZES, 0.02)
    missed = np.sqrt(np.mean(again(at) ** 2))  # the log's filter rounds the corners of a dead band
    bare = np.sqrt(np.mean(again({"rig.inertia": 0.03, "rig.viscous": 0.2}) ** 2))
    assert missed < 0.01 * bare


def test_what_is_kept_of_other_numbers_changes_nothing():
    """One number after another is moved and put back, as a set of derivatives does it."""
    rig = RigFile.model_validate(description())
    possible, _ = applicable(list(LIBRARY.values()), rig, False, 1.0, True)
    names = [e.name() for e in possible if e.port != "sensing.frame"]
    made, fresh = problem(*names), problem(*names)
    at = {"rig.inertia": 0.03, "rig.viscous": 0.2, "rig.delay": 0.001}
    at |= {f"{e.name()}.{f}": p.nominal for e in possible for f, p in e.parameters().items()}
    at = {name: value for name, value in at.items() if name.partition(".")[0] in ("rig", *names)}
    for name, value in at.items():
        moved = {**at, name: 1.001 * value}
        p = fresh.table.vector(moved)
        fresh.asked = fresh.asked.__class__(
            made.asked.motion, fresh.asked.effects, fresh.table, SIZES, 0.02, 0.0, False
        )
        for near in (True, False):
            np.testing.assert_array_equal(made.asked.effort(p, near), fresh.asked.effort(p, near))
    held = made.asked.effort(made.table.vector(at), near=True)
    np.testing.assert_array_equal(held, fresh.asked.effort(fresh.table.vector(at), near=True))


def test_what_was_asked_for_longest_ago_is_made_again():
    made = []
    kept = Cache(2)
    for key in "abacab":
        assert kept(key, lambda key=key: made.append(key) or key.upper()) == key.upper()
    assert made == ["a", "b", "c", "b"]
    assert [key for key, _ in kept.items()] == ["a", "b"]


@pytest.mark.parametrize(("iron", "wanted"), [(0.0, 1.0), (0.5, 1.0), (20.0, 1.0), (20.0, -5.0)])
def test_full_iron_is_compared_by_the_torque_of_an_ampere(iron, wanted):
    """e = τ·√(1 + s·e₀²), however far the torque τ is from what the current e₀ makes of it."""
    made = problem("torque_constant_saturation")
    motion = made.asked.motion
    at = {"rig.inertia": 0.0, "rig.viscous": wanted, "torque_constant_saturation.saturation": iron}
    found = made.asked.effort(made.table.vector(at), near=True)
    per_ampere = 1.0 / np.sqrt(1.0 + iron * motion.effort**2)
    expected = wanted * motion.v / per_ampere
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())


def test_held_out_full_iron_is_compared_by_what_an_ampere_more_gives():
    """e = e₀ + (τ - P(e₀))/P'(e₀); the torque of all amperes hides most of what is missed."""
    iron, missed = 0.5, []
    for held_out in (False, True):
        made = problem("torque_constant_saturation")
        made.asked.held_out = held_out
        current = made.asked.motion.effort
        passed = current / np.sqrt(1.0 + iron * current**2)
        at = {"rig.inertia": 0.0, "rig.viscous": 1.0, "torque_constant_saturation.saturation": iron}
        found = made.asked.effort(made.table.vector(at), near=True)
        missed.append((found - current) / (made.asked.motion.v - passed))
    slope = (1.0 + iron * current**2) ** -1.5
    np.testing.assert_allclose(missed[1], 1.0 / slope, rtol=1e-3)
    assert np.all(missed[1] >= missed[0] - 1e-9)


@pytest.mark.parametrize("held_out", [False, True])
def test_a_further_effect_is_judged_in_the_same_role(held_out):
    rig, numbers = (
        RigFile.model_validate(description()),
        {"torque_constant_saturation.saturation": 0.5},
    )
    iron, trials = [LIBRARY["torque_constant_saturation"]], [prepare("log", log(), rig)]
    made = InverseProblem(rig, None, trials, iron, SIZES, 0.02, held_out=held_out)
    more = made.beside(LIBRARY["coulomb_friction"])
    at = numbers | {"rig.inertia": 0.0, "rig.viscous": 1.0}
    np.testing.assert_array_equal(more(at), made(at))
    other = InverseProblem(rig, None, trials, iron, SIZES, 0.02, held_out=not held_out)
    assert np.abs(more(at) - other(at)).max() > 0.1


@pytest.mark.parametrize("before", [(), ("torque_constant_saturation",), ("current_lag",)])
@pytest.mark.parametrize("name", ["coulomb_friction", "load_dependent_friction", "current_offset"])
def test_what_an_effect_adds_is_the_difference_that_it_makes(name, before):
    """Also behind a pipe, where a torque is not simply added."""
    made = problem(name, *before)
    numbers = {f"{e}.{f}": p.nominal for e in before for f, p in LIBRARY[e].parameters().items()}
    at = {"rig.inertia": 0.03, "rig.viscous": 0.2, "rig.delay": 0.003, **numbers}
    own = {f"{name}.{f}": p.nominal for f, p in LIBRARY[name].parameters().items()}
    without, whole = made(at), made({**at, **own})
    assert np.abs(whole - without).max() > 0.0
    added = made.added(LIBRARY[name], {**at, **own}, without)
    np.testing.assert_allclose(added, whole - without, atol=1e-12 * np.abs(whole).max())


@pytest.mark.parametrize("count", [4, 24, 25, 300])
@pytest.mark.parametrize("delay", [0.0, 1e-4, -3e-4, 2e-3, 0.0237])
def test_a_late_effort_is_its_series_of_second_order(count, delay):
    """In whole samples it moves; what is left is e - r·e' + r²/2·e'', at the ends as well."""
    random = np.random.default_rng(count)
    motion = problem().asked.motion
    starts, steps = np.array([0, count, 2 * count]), np.array([2e-3, 1e-3])
    pieces = replace(motion, starts=starts, steps=steps)
    effort = random.standard_normal(2 * count)
    found = late(effort, delay, pieces)
    for k, step in enumerate(steps):
        own = slice(starts[k], starts[k + 1])
        whole = round(delay / step)
        rest = delay - whole * step
        first, second = rates(effort[own], step)
        series = effort[own] - rest * first + 0.5 * rest**2 * second
        at = np.clip(np.arange(count) - whole, 0, count - 1)
        np.testing.assert_allclose(found[own], series[at], atol=1e-12)


def test_a_ratio_shapes_the_second_wave_alone():
    cogging = LIBRARY["cogging"]
    assert shaping(cogging, "sine") == ("order",)
    assert shaping(cogging, "second_cosine") == ("order", "ratio")
    # a memory is asked for nothing: all of its shape may matter later
    friction = LIBRARY["presliding_friction"]
    shape = tuple(f for f in friction.parameters() if f not in friction.neutral)
    assert shaping(friction, "sliding_torque") == shape


@pytest.mark.parametrize("name", ["coulomb_friction", "presliding_friction", "current_lag"])
def test_the_compiled_loop_is_the_kernel(name):
    effect = LIBRARY[name]
    rng = np.random.default_rng(1)
    n, dt = 50, 1e-3
    reads = np.abs(rng.standard_normal((len(effect.reads), n))) + 0.1
    upstream = rng.standard_normal(n)
    numbers = [p.nominal for p in effect.parameters().values()]
    out = np.empty(n)
    starts, steps = np.array([0, 20, n]), np.array([dt, dt])
    begin, anew = np.array(list(effect.state.values())), np.ones(2, bool)
    loop_of(effect)(out, starts, steps, anew, begin, upstream, reads, np.array(numbers))
    expected = []
    for k in range(n):
        if k in (0, 20):
            memory = dict(effect.state)
        given = {a: reads[j, k] for j, a in enumerate(effect.reads)}
        given |= dict(zip(effect.parameters(), numbers, strict=True)) | memory
        given |= {"upstream": upstream[k], "dt": dt}
        got = effect.kernel(**{a: given[a] for a in effect.arguments()})
        if effect.state:
            memory = dict(zip(effect.state, got[1:], strict=True))
            got = got[0]
        expected.append(got)
    np.testing.assert_allclose(out, expected, rtol=1e-12)


def test_units_follow_the_rig():
    linear = Sizes(50.0, 0.1, 0.04, 0.2, 50.0, 0.1, "N", "N", "m")
    assert dimensions("N·m·s²/rad²") == {"torque": 1, "speed": -2}
    assert linear.unit("N·m·s/rad") == "N·s/m"
    assert linear.unit("N·m·s²/rad²") == "N·s²/m²"
    assert linear.unit("1/A²") == "1/N²"
    coulomb = linear.parameter(LIBRARY["coulomb_friction"].parameters()["coulomb_torque"])
    assert (coulomb.unit, coulomb.low) == ("N", 0.0)
    assert 0.02 < coulomb.nominal / linear.torque < 0.5  # a share of this rig's effort


def test_numbers_that_count_periods_are_recognised_by_the_kernel_itself():
    assert counts_periods(LIBRARY["cogging"], "order")
    assert counts_periods(LIBRARY["torque_ripple"], "order")
    assert not counts_periods(LIBRARY["coulomb_friction"], "softness")
    assert not counts_periods(LIBRARY["stiffness_hardening"], "hardening")


def test_a_wave_has_to_come_round_to_be_called_one():
    order = parameters(LIBRARY["cogging"], SIZES)["order"]
    assert order.low * SIZES.stroke / SIZES.angle == pytest.approx(2 * 2 * np.pi)
    assert order.low <= order.nominal <= order.high


def test_the_order_of_a_ripple_is_found_before_any_fit():
    rng = np.random.default_rng(0)
    angle = np.cumsum(rng.uniform(0, 0.02, 4000))
    ripple = np.sin(7.3 * angle + 1) + 0.5 * rng.standard_normal(4000)
    assert peaks(ripple, angle, 0.01, 100.0)[0] == pytest.approx(7.3, abs=0.05)


def test_effects_without_a_place_are_left_out_with_a_reason():
    rig = RigFile.model_validate(description())
    possible, excluded = applicable(list(LIBRARY.values()), rig, False, 0.0, True)
    assert {e.name() for e in possible} | set(excluded) == set(LIBRARY)
    assert "capstan_friction" in excluded
    assert "commanded effort" in excluded["driver_dead_band"]
    sensor = {"column": "u", "unit": "N·m", "kind": "torque", "origin": "sensor"}
    other = RigFile.model_validate(description(effort=sensor))
    assert (
        "sensor" in applicable(list(LIBRARY.values()), other, False, 0.0, True)[1]["torque_ripple"]
    )


@pytest.mark.parametrize("kind", ["voltage", "current"])
def test_a_voltage_is_regulated_by_no_sensor_of_a_current(kind):
    """The reading of a current follows its command, so that of the sensor is another one."""
    effort = {"column": "u", "unit": "V" if kind == "voltage" else "A", "kind": kind}
    rig = RigFile.model_validate(description() | {"effort": effort | {"origin": "command"}})
    _, excluded = applicable(list(LIBRARY.values()), rig, False, 0.0, True)
    for name in ("current_offset", "current_gain"):
        assert ("no sensor of a current" in excluded.get(name, "")) is (kind == "voltage")


def test_a_back_emf_is_added_in_proportion_to_speed():
    effort = {"column": "u", "unit": "V", "kind": "voltage"}
    made = problem(effort=effort, known={"back_emf": 0.25})
    bare = {"rig.inertia": 0.03, "rig.viscous": 0.2}
    without, signals = problem(effort=effort), made.signals()
    expected = without(bare) + 0.25 * signals["speed"]
    np.testing.assert_allclose(made(bare), expected, atol=2e-3 * np.ptp(expected))


def test_a_load_on_a_soft_gear_has_its_motor_move_by_the_twist_besides():
    """τ = J·a + μ·J·φ'', φ = c·J·a: for a sine of ω, J·a·(1 - μ·c·J·ω²)."""
    position = {"column": "q", "unit": "rad", "side": "load"}
    rig = RigFile.model_validate(description(position=position))
    law, w, t = load_side.GearCompliance, 2 * np.pi * 2.0, np.arange(0, 6, 2e-3)
    log = {"t": t, "q": np.sin(w * t), "u": np.cos(t)}
    made = InverseProblem(rig, None, [prepare("log", log, rig)], [law], SIZES, 0.02)
    numbers = {"gear_compliance.compliance": 0.05, "gear_compliance.rotor_share": 0.3}
    base = {"rig.inertia": 0.03, "rig.viscous": 0.0}
    stiff = made(base) + made.measured()
    soft = made(base | numbers) + made.measured()
    expected = stiff * (1 - 0.3 * 0.05 * 0.03 * w**2)
    assert 1 - 0.3 * 0.05 * 0.03 * w**2 < 0.95
    np.testing.assert_allclose(soft, expected, atol=2e-3 * np.abs(expected).max())


def test_of_a_described_body_the_fitted_inertia_is_the_motor_s_and_no_load(tmp_path):
    """Friction by the load feels the body alone; the motor's effort moves both."""
    (tmp_path / "arm.xml").write_text(PENDULUM)
    rig = RigFile.model_validate(description(body={"mjcf": "arm.xml", "joint": "shoulder"}))
    body = RigidBody(rig.body, tmp_path, True)
    effects = for_axis([LIBRARY["load_dependent_friction"]], shared=False)
    made = InverseProblem(rig, body, [prepare("log", log(), rig)], effects, SIZES, 0.02)
    asked, motion = made.asked, made.asked.motion
    light, heavy = ({"rig.viscous": 0.0, "rig.inertia": j} for j in (0.0, 0.4))
    rubs = {"load_dependent_friction.loss_ratio": 0.2}
    without, own = (made.table.vector(x | rubs) for x in (light, heavy))
    np.testing.assert_array_equal(asked.load(motion, own), asked.load(motion, without))
    moved = asked.effort(own) - asked.effort(without)
    np.testing.assert_allclose(moved, 0.4 * motion.a, atol=1e-9 * np.abs(motion.a).max())
