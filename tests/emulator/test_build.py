"""Builds: how robots of one drawing differ, and what stays the same."""

import functools
import hashlib
import json
from dataclasses import replace

import numpy as np
import pytest

from spirob.can_protocol import encode_command
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.emulator.build import BUILDS, ROWS, Build, anatomy, built
from spirob.emulator.machine import CYCLE, Machine
from spirob.emulator.physics import HINGES, SIDES
from spirob.emulator.rig import draw, numbers_of
from spirob.errors import ConfigError
from spirob.geometry import spiral_arm
from spirob.logs import read_log
from spirob.robot import Scene
from tests.emulator.conftest import hinge_angles, loosen, play
from tests.emulator.test_arm import energy, mass_matrix
from tests.trials.trials import record_on

ARM = spiral_arm(HINGES)
SHEET = draw(np.random.default_rng(0))
SEEDS = range(400)
CUT = 0.959  # deviation of a normal number that is cut at two
DRAWN = [name for name in BUILDS if name != "as_designed"]


@functools.cache
def drawn(name: str) -> list[Build]:
    return [built(name, ARM, SHEET, np.random.default_rng([seed, 5])) for seed in SEEDS]


def rows(name: str, row: str) -> np.ndarray:
    """What was drawn of a row, one robot after the other."""
    return np.array([build.rows[row] for build in drawn(name)])


def frames(build: str, seed: int = 1, cycles: int = 200) -> list[bytes]:
    robot = EmulatedRobot(EmulatedRig(), HiddenSettings("guide_friction", build=build), seed)
    robot.prepare(Scene(), "a")
    played = [robot.exchange(encode_command((0.6, 0.1))) for _ in range(cycles)]
    robot.close()
    return [frame.data for cycle in played for frame in cycle]


def test_as_designed_is_the_drawings_arm_to_the_last_bit():
    digest = hashlib.sha256(b"".join(frames("as_designed")))
    assert digest.hexdigest()[:16] == "9e808047b752557c"
    plain = built("as_designed", ARM, SHEET, np.random.default_rng(0))
    assert plain.sheet == SHEET
    assert plain.arm is ARM
    assert np.array_equal(plain.before, [ARM.guide_before] * 2)
    assert np.array_equal(plain.after, [ARM.guide_after] * 2)
    assert plain.rows == {}


@pytest.mark.parametrize("name", DRAWN)
def test_a_build_changes_nothing_but_the_build(name):
    effects = HiddenSettings("cogging+guide_friction")
    plain, made = (Machine(EmulatedRig(), replace(effects, build=b), 4) for b in (BUILDS[0], name))
    for number, value in plain.drawn.items():
        assert np.array_equal(made.drawn[number], value)
    for one, other in zip(made.hidden, plain.hidden, strict=True):
        assert one.plain == other.plain
    starts = []
    for machine in (plain, made):
        machine.start(Scene(), "a")
        starts.append(machine.state["rotor_start"][0].tolist())
    assert starts[0] == starts[1]


@pytest.mark.parametrize("name", DRAWN)
def test_the_same_seed_is_the_same_robot_and_another_another(name):
    assert frames(name, cycles=60) == frames(name, cycles=60)
    assert frames(name, cycles=60) != frames(name, seed=2, cycles=60)
    assert frames(name, cycles=60) != frames("as_designed", cycles=60)


@pytest.mark.parametrize("name", DRAWN)
@pytest.mark.parametrize("row", ["hinge_stiffness", "hinge_damping", "unit_mass"])
def test_hinges_and_units_scatter_as_much_as_the_table_says_each_on_its_own(name, row):
    factors = rows(name, row)
    assert factors.std() == pytest.approx(CUT * getattr(ROWS[row], name), rel=0.03)
    assert factors.mean() == pytest.approx(1.0, abs=0.01)
    between = np.corrcoef(factors.T)[~np.eye(HINGES, dtype=bool)]
    assert abs(between.mean()) < 0.01
    assert np.abs(between).max() < 5 / np.sqrt(len(SEEDS))


@pytest.mark.parametrize("name", DRAWN)
def test_rows_do_not_follow_each_other(name):
    kinds = np.array([rows(name, row).ravel() for row in ("hinge_stiffness", "unit_mass")])
    assert abs(np.corrcoef(kinds)[0, 1]) < 5 / np.sqrt(kinds.shape[1])


def test_a_flexures_stiffness_goes_with_the_cube_of_its_thickness():
    thickness = np.cbrt(rows("rough", "hinge_stiffness"))
    assert thickness.mean() == pytest.approx(1.0, abs=0.001)
    assert thickness.max() == pytest.approx(1 + 2 * 0.12 / 3, rel=1e-3)


LIMITS = {
    "stiffness_exponent": {"typical": (0.0, 0.0), "rough": (-0.3, 0.3)},
    "unit_length": {"typical": (-0.003, 0.003), "rough": (-0.003, 0.003)},
    "mount_hole": {"typical": (0.0, 0.010), "rough": (0.0, 0.020)},
    "hole_shift": {"typical": (-0.002, 0.002), "rough": (-0.006, 0.006)},
    "hole": {"typical": (-0.0003, 0.0003), "rough": (-0.0003, 0.0003)},
    "drum": {"typical": (-0.01, 0.01), "rough": (-0.01, 0.01)},
    "gear_stiffness": {"typical": (150.0, 600.0), "rough": (150.0, 600.0)},
}


@pytest.mark.parametrize("name", DRAWN)
@pytest.mark.parametrize("row", LIMITS)
def test_even_draws_fill_their_range_and_no_more(name, row):
    low, high = LIMITS[row][name]
    found = rows(name, row)
    assert low <= found.min()
    assert found.max() <= high
    assert np.ptp(found) >= 0.97 * (high - low)


@pytest.mark.parametrize("name", DRAWN)
def test_neither_side_is_favoured(name):
    for row in ("drum", "gear_stiffness", "hole"):
        left, right = np.moveaxis(rows(name, row), 1, 0)
        apart = (left - right).reshape(len(SEEDS), -1).mean(axis=1)
        assert abs(apart.mean()) < 4 * apart.std() / np.sqrt(len(SEEDS))
        assert abs(np.corrcoef(left.ravel(), right.ravel())[0, 1]) < 5 / np.sqrt(left.size)


@pytest.mark.parametrize("name", DRAWN)
def test_every_build_can_be(name):
    for build in drawn(name):
        leave = build.before[:, 1:] + np.column_stack([build.arm.unit_length, np.zeros(48)])[:-1]
        assert (build.before[..., 0] < build.after[..., 0]).all()
        assert (build.after[:, :-1, 0] < leave[..., 0]).all()
        assert (build.after[..., 1] > 0.0).all()
        assert (build.after[..., 1] < build.arm.half_width).all()


def test_a_build_that_cannot_be_is_drawn_again():
    offered = iter([-0.03, 0.03, -0.03, 0.0])
    again = replace(ROWS["hole_shift"], draw=lambda rng, width: np.array(next(offered)))
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(ROWS, "hole_shift", again)
        found = built("typical", ARM, SHEET, np.random.default_rng(3))
    assert found.rows["hole_shift"] == 0.0
    assert next(offered, None) is None


@pytest.mark.parametrize(
    ("row", "value", "said"),
    [
        ("hole", np.full((SIDES, HINGES + 1, 2), 0.05), "unit 1 on the left .* the unit's edge"),
        ("hole", np.full((SIDES, HINGES + 1, 2), -0.05), "unit 1 on the left lies beyond the axis"),
        ("hole_shift", np.array(0.03), "nearer to the tip than its unit"),
        ("hole_shift", np.array(-0.03), "nearer to the base than its unit"),
        ("mount_hole", np.array(-0.03), "begins before the hole nearer to the base ends"),
    ],
)
def test_what_can_never_be_is_a_sentence(row, value, said, monkeypatch):
    monkeypatch.setitem(ROWS, row, replace(ROWS[row], draw=lambda rng, width: value))
    with pytest.raises(ConfigError, match=said) as refused:
        built("rough", ARM, SHEET, np.random.default_rng(0))
    assert str(refused.value).startswith("emulated robot: none of 100 builds 'rough'")
    assert "\n" not in str(refused.value)


def test_an_unknown_build_is_a_sentence():
    with pytest.raises(ConfigError, match=r"no build 'perfect'.*: as_designed, typical, rough"):
        HiddenSettings("none", build="perfect")


def test_a_smaller_arm_of_the_same_draws_is_the_same_arm_scaled():
    small = spiral_arm(HINGES, 0.25)
    quarter, whole = (built("rough", arm, SHEET, np.random.default_rng(1)) for arm in (small, ARM))
    for name in ("before", "after"):
        assert 4 * getattr(quarter, name) == pytest.approx(getattr(whole, name), abs=1e-12)
    assert 4 * quarter.arm.unit_length == pytest.approx(whole.arm.unit_length)


def test_a_hole_moves_as_a_whole_within_what_its_unit_allows(monkeypatch):
    for row in ("hole_shift", "mount_hole"):
        monkeypatch.setitem(ROWS, row, replace(ROWS[row], put=lambda build, value: build))
    build = built("typical", ARM, SHEET, np.random.default_rng(1))
    enters, leaves = build.after - ARM.guide_after, build.before - ARM.guide_before
    assert enters[:, :-1] == pytest.approx(leaves[:, 1:], abs=1e-12)
    limit = 0.0003 * build.scale[:, None]
    assert (np.abs(enters) <= limit).all()
    assert (np.abs(enters) > 0.8 * limit).any()


def test_tendons_run_through_the_holes_as_built(machine):
    made = machine(build="rough")
    made.state["phi"][0] = np.cumsum(np.linspace(-0.1, 0.2, HINGES))
    made._advance(made.numbers, np.zeros(2), steps=0)
    q = hinge_angles(made)
    for m, side in enumerate((1.0, -1.0)):
        flip = np.array([1.0, side])
        before, after = flip * made.build.before[m], flip * made.build.after[m]
        turn = np.array([[np.cos(q), -np.sin(q)], [np.sin(q), np.cos(q)]])
        bent = np.einsum("jki,ik->ij", turn, after)
        spans = [np.linalg.norm(each - before, axis=1).sum() for each in (after, bent)]
        assert made._scratch["shortening"][0, m] == pytest.approx(spans[0] - spans[1], rel=1e-9)


def held(made: Machine) -> float:
    """Energy of arm and tendons."""
    made._advance(made.numbers, np.zeros(2), steps=0)
    stretch = np.maximum(made.state["wound"][0] - made._scratch["shortening"][0], 0.0)
    tight = 0.5 * made.numbers["tendon_stiffness"][0] @ stretch**2
    return energy(made, anatomy(made.build.arm)) + tight


def power(made: Machine) -> float:
    """What hinges and tendons lose per second."""
    p, lever = made.numbers[0], made._scratch["lever"][0]
    rate = np.diff(made.state["rate"][0], prepend=0.0)
    return p["damping"] @ rate**2 + p["tendon_damping"] @ (lever @ rate) ** 2


def test_energy_of_a_rough_build_is_where_it_was_or_was_lost_in_hinges_and_tendons(machine):
    """It swings while both tendons pull at drums that stand."""
    made = machine(build="rough")
    made.numbers["winch_inertia"] = 1e9
    made.state["wound"][0] += 2e-4
    made.state["rate"][0] = np.cumsum(np.random.default_rng(0).uniform(-0.3, 0.3, HINGES))
    first, lost, h = held(made), 0.0, 2e-5
    for _ in range(4000):
        made._advance(made.numbers, np.zeros(2), steps=1, dt=h)
        lost += h * power(made)
        assert (made.state["tension"][0] > 0.0).all()
    assert first - held(made) == pytest.approx(lost, rel=0.01)
    assert lost > 0.05 * first


def test_the_mass_matrix_of_a_rough_build_is_that_of_its_own_units(machine):
    made = machine(build="rough")
    loosen(made)
    made.state["phi"][0] = phi = np.cumsum(np.linspace(-0.05, 0.05, HINGES))
    made.dt = 1e-13
    made._advance(made.numbers, np.zeros(2), steps=1)
    w = made._scratch
    u, v = w["u"][0], w["v"][0]
    system = np.tril(u @ v.T, -1) + np.diag(w["sub"][0, 1:], -1)
    system = system + system.T + np.diag(w["diagonal"][0])
    expected = mass_matrix(made, phi, anatomy(made.build.arm))
    np.testing.assert_allclose(system, expected, rtol=1e-6, atol=1e-9 * expected.max())


def test_the_truth_holds_every_number_that_was_drawn():
    robot = EmulatedRobot(EmulatedRig(), HiddenSettings("none", build="rough"), seed=6)
    truth = json.loads(json.dumps(robot.truth()))
    robot.close()
    told = truth["build"]
    assert told["name"] == "rough"
    assert told["rows"].keys() == ROWS.keys()
    sheet = {name: np.array(value) for name, value in truth["drawn"].items()}
    rebuilt = built("as_designed", ARM, sheet, np.random.default_rng(0))
    for name, row in ROWS.items():
        rebuilt = row.put(rebuilt, np.array(told["rows"][name]))
    rig = EmulatedRig()
    numbers = numbers_of(rig, rebuilt, CYCLE / rig.steps_per_cycle)
    for name, value in truth["numbers"].items():
        np.testing.assert_allclose(value, numbers[name][0], rtol=1e-12, err_msg=name)


def test_the_log_says_nothing_of_the_build(tmp_path):
    metas = []
    for name in BUILDS:
        robot = EmulatedRobot(EmulatedRig(), HiddenSettings("none", build=name), seed=6)
        log = record_on(robot, tmp_path, 0.15, f"{name}.mcap", scene={})
        robot.close()
        metas.append(json.dumps(read_log(log).meta, default=str, sort_keys=True))
        raw = log.read_bytes()
        assert not [row for row in ROWS if row.encode() in raw]
    assert metas[0] == metas[1] == metas[2]


@pytest.mark.parametrize("seed", [1, 2])
def test_a_rough_build_driven_hard_stays_finite_and_near_its_stops(machine, seed):
    made = machine(build="rough", seed=seed, clean=False)
    for currents in ((2.0, 0.2), (0.2, 2.0)):
        play(made, currents, 700)
        assert np.isfinite(made.state["phi"][0]).all()
        assert np.rad2deg(np.abs(hinge_angles(made))).max() < 16.0


def test_a_machine_built_anew_keeps_its_data_sheet_and_what_it_hides():
    def truth(built):
        hidden = HiddenSettings("guide_friction", build="typical", built=built)
        robot = EmulatedRobot(EmulatedRig(), hidden, seed=6)
        robot.close()
        return robot.truth()

    own, anew, same = truth(None), truth(7), truth(6)
    assert own == same
    assert own["hidden"] == anew["hidden"]
    assert not np.allclose(own["build"]["rows"]["hole"], anew["build"]["rows"]["hole"])
    apart = {"stiffness", "damping_time", "mass", "winch_radius", "gear_stiffness"}
    for name in own["drawn"].keys() - apart:
        np.testing.assert_array_equal(own["drawn"][name], anew["drawn"][name], err_msg=name)
