"""An arm of 13 units and another taper: from the emulated robot by a table of units to a name."""

import pandas as pd
import pytest
import yaml

from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.proposals import bend
from spirob.effects import all_effects
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.errors import DataError
from spirob.geometry import Drawing
from spirob.logs import read_log
from spirob.logs.readers import Table, read_table
from spirob.machine.arm import diagnosis
from spirob.machine.arm.replay import arm_trial
from spirob.machine.loading import load_rig
from spirob.plant import Rig
from spirob.plant.tendon import stroke
from spirob.trials import Trial, record
from tests.machine.arm.elsewhere import description, log, rig
from tests.plant.measuring import rows_of, written

DRAWN = Drawing.from_mapping(
    {"units": 13, "b": 0.3, "length": 0.2, "base_width": 0.06, "hole_base": 0.8, "mount": 4e-3}
)
# the table is known, so that no other shape is asked for
FITTED = (
    "winch.efficiency",
    "motor.rotor_damping",
    "motor.rotor_inertia",
    "arm.base_stiffness",
    "arm.bends_per_hinge",
)
NAMES = ("load_dependent_friction", "coulomb_friction", "quadratic_drag")
MOVES = {  # of a motor against a current of the other; lengths over the stroke
    "a_left": ("left", ((0.1, 0.0), (1.2, 0.25), (0.7, 0.18)), 0.6),
    "b_right": ("right", ((0.1, 0.0), (0.7, 0.08), (0.6, 0.03), (0.6, 0.07)), 1.2),
    "c_right": ("right", ((0.1, 0.0), (1.0, 0.22), (0.8, 0.12)), 0.8),
    "d_left": ("left", ((0.1, 0.0), (0.9, 0.15), (0.8, 0.06)), 1.0),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The description with its table of units, and the robot's logs as CSV."""
    found, machine = tmp_path_factory.mktemp("elsewhere"), Rig(geometry=DRAWN)
    said = description(arm={"geometry": {"table": "units.csv"}}, fit=list(FITTED))
    for motor in ("left", "right"):
        said[motor]["position"] = {"column": f"{motor} length", "unit": "mm"}
        said[motor]["effort"]["unit"] = "A"
    (found / "rig.yaml").write_text(yaml.safe_dump(said))
    (found / "units.csv").write_text(written(rows_of(DRAWN.arm())))
    robot = EmulatedRobot(EmulatedRig(geometry=DRAWN), HiddenSettings("load_friction", 1.5), seed=5)
    for name, (motor, moves, against) in MOVES.items():
        way = [(lasts, share * stroke(DRAWN.arm())) for lasts, share in moves]
        trial = bend(name, "train", motor, way, {"kind": "constant", "value": against})
        played(robot, machine, Trial.from_plain(trial), found)
    robot.close()
    return found


def played(robot, machine, trial, folder):
    path = folder / f"{trial.name}.mcap"
    record(
        trial,
        robot,
        path,
        machine,
    )
    trace = read_log(path)
    columns = {"ms": 1e3 * trace.seconds}
    for motor in ("left", "right"):
        columns[f"{motor} length"] = 1e3 * trace[f"{motor}.displacement"]
        columns[f"{motor} current"] = trace[f"{motor}.current"]
    pd.DataFrame(columns).to_csv(path.with_suffix(".csv"), index=False)


def test_what_an_arm_of_13_measured_units_hides_is_named(folder):
    arm, beside = load_rig(folder / "rig.yaml")
    arm = arm.beside(beside)
    logs = [read_table(str(folder / f"{name}.csv")) for name in MOVES]
    trials, said = diagnosis.read(arm, logs[:3], logs[3:])
    settings = Settings(finalists=2, most=1, iterations=1, intervals=False)
    library = [all_effects()[name] for name in NAMES]
    found = diagnosis.searched(arm, trials, settings, print, library, said=said)
    assert found.models.train.plant.rig.units == 13
    document = diagnosis.written(arm, found, said)
    assert [effect["name"] for effect in document["effects"]] == ["load_dependent_friction"]
    before, after = (document["ladder"][k]["test"]["rmse"] for k in (0, 1))
    assert after < 0.4 * before
    assert after < 0.02 * document["effort_rms"]["test"]


def test_the_same_logs_say_that_they_are_not_of_the_published_arm_where_they_cannot_be(folder):
    """The other way round: a stroke of the published arm is more than the short one has."""
    columns = log("train", 0, {})
    drawn = rig(arm={"geometry": {"units": 13, "b": 0.3, "length": 0.05, "base_width": 0.015}})
    arm_trial(Table("ours", columns), rig(), "train")
    with pytest.raises(DataError, match=r"ours: 'left angle' has wound in .* the arm's stroke is"):
        arm_trial(Table("ours", columns), drawn, "train")


def test_angles_in_degrees_that_are_read_as_turns_are_more_than_the_stroke():
    left = description()["left"]
    turns = rig(left={**left, "position": {"column": "left angle", "unit": "turn"}})
    with pytest.raises(DataError, match=r"'left angle' has wound in .* a unit, the gear"):
        arm_trial(Table("ours", log("train", 0, {})), turns, "train")
