"""Numbers of the arm's model that a description fits between bounds of its own, or knows."""

import pandas as pd
import pytest

from spirob.cli.main import main
from spirob.diagnosis.criteria import Settings
from spirob.effects import all_effects
from spirob.errors import ConfigError
from spirob.identify.builds import TOLERANCES
from spirob.identify.problem import FITTED
from spirob.machine.arm import diagnosis
from spirob.machine.arm.description import described
from spirob.machine.arm.diagnosis import parameters
from spirob.machine.loading import load_rig
from spirob.plant import Plant
from tests.machine.arm.elsewhere import log, rig, tables, write

FRICTION = all_effects()["coulomb_friction"]
TRUE = {"winch.efficiency": 0.7, "motor.rotor_damping": 2e-4}
DAMPING = {"motor.rotor_damping": 2e-4}
BARE = {"winch.efficiency": None}
TORQUE = "coulomb_friction.coulomb_torque"
LOGS = (("train", 0), ("train", 1), ("validate", 0), ("heldout", 0))
QUICK = Settings(finalists=1, most=0, intervals=False)


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("logs")
    paths = [folder / f"{role}_{k}.csv" for role, k in LOGS]
    for path, (role, k) in zip(paths, LOGS, strict=True):
        pd.DataFrame(log(role, k, TRUE)).to_csv(path, index=False)
    return paths


def fitted(logs, **changes):
    """A search for nothing: the fit of the numbers alone."""
    arm = rig(**changes)
    trials, _ = diagnosis.read(arm, tables(logs[:3]), tables(logs[3:]))
    return diagnosis.searched(arm, trials, QUICK, print, [])


def plant(arm, own=()):
    return described(Plant(arm.machine(), [*own]), arm, own)


def test_a_list_and_a_mapping_without_bounds_are_the_same():
    names = ["winch.efficiency", "motor.rotor_damping"]
    assert rig(fit=names).fitted() == rig(fit=dict.fromkeys(names)).fitted()
    # the others are of the build, and asked for where they show
    assert list(rig().fitted()) == [n for n in FITTED if n not in TOLERANCES]
    before, after = Plant(rig().machine()).table, plant(rig()).table
    assert before.about == after.about
    assert (before.values == after.values).all()


def test_a_fit_stays_between_bounds_and_begins_at_what_is_nominal(logs):
    """The efficiency is 0.7: between 0.8 and 0.9 it ends at 0.8, and the page says so."""
    narrow = {"nominal": 0.85, "low": 0.8, "high": 0.9}
    found = fitted(logs, fit={"winch.efficiency": narrow}, known=DAMPING)
    shown = parameters(found)["winch.efficiency"]
    assert shown["value"] == pytest.approx(0.8, abs=1e-4)
    assert shown["at_bound"]
    assert (shown["nominal"], shown["bound_low"], shown["bound_high"]) == (0.85, 0.8, 0.9)


def test_bounds_may_be_wider_than_the_data_sheets_tolerance():
    wide = {"winch.efficiency": {"nominal": 0.7, "low": 0.6, "high": 1.0}}
    table = plant(rig(fit=wide)).table
    assert table.about["winch.efficiency"].reach(0.7) == (0.6, 1.0)
    assert table.values[table.position("winch.efficiency")] == 0.7


def test_what_is_known_is_not_fitted_and_the_rest_is_right(logs):
    """With a damping that is known to be twice the nominal one the efficiency is found."""
    found = fitted(logs, fit=["winch.efficiency"], known=DAMPING)
    estimates, table = found.stands.fit.estimates, found.models.train.table
    assert set(estimates) == {"winch.efficiency"}
    assert estimates["winch.efficiency"].value == pytest.approx(0.7, rel=0.01)
    assert table.values[table.position("motor.rotor_damping")] == 2e-4
    assert "motor.rotor_damping" not in rig(known=DAMPING).fitted()


def test_a_known_part_is_that_of_the_machine_with_which_positions_are_read():
    arm = rig(known={"winch.gear_ratio": 1.0}, arm={"winch": {"radius": 0.03}})
    winch = arm.machine().winch
    assert (winch.gear_ratio, winch.radius) == (1.0, 0.03)


def test_numbers_of_an_effect_that_the_model_holds(logs):
    """One is known, another fitted between bounds; of an absent effect neither can be."""
    known, chosen = "coulomb_friction.softness", "coulomb_friction.coulomb_torque"
    bounds = {chosen: {"nominal": 0.003, "low": 0.002, "high": 0.004}}
    found = fitted(logs, effects=["coulomb_friction"], fit={**BARE, **bounds}, known={known: 0.7})
    estimates, table = found.stands.fit.estimates, found.models.train.table
    assert set(estimates) == {*BARE, chosen}
    assert 0.002 <= estimates[chosen].value < 0.0025  # the truth, 0, is out of bounds
    assert table.values[table.position(known)] == 0.7


@pytest.mark.parametrize("changes", [{"fit": [TORQUE]}, {"known": {TORQUE: 0.001}}])
def test_numbers_of_an_absent_effect_are_refused(changes):
    arm = rig(**changes)
    with pytest.raises(ConfigError, match=f": '{TORQUE}' is of an effect that is not among 'eff"):
        described(Plant(arm.machine(), [FRICTION]), arm, [])


WIDE = {"winch.efficiency": {"nominal": 0.7, "low": 0.1, "high": 1.0}}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"fit": {"winch.colour": None}}, r"fit: the arm's model has no number 'winch\.colour'; w"),
        ({"fit": ["efficiency"]}, "no number 'efficiency'; its parts: arm, drive, holes, motor, "),
        ({"known": {"arm.colour": 1.0}}, "arm has no number 'colour'; it has: base_stiffness"),
        ({"fit": WIDE}, r"fit\.winch\.efficiency: 0\.1 to 1 reaches beyond .*, 0\.6 to 1 1 \(torq"),
        ({"known": {"winch.efficiency": 2.0}}, r"winch\.efficiency = 2\.0 1 is out of range"),
    ],
)
def test_a_number_that_there_is_not_is_named(changes, sentence):
    arm = rig(**changes)
    with pytest.raises(ConfigError, match=sentence):
        plant(arm)


TURNED = {"winch.efficiency": {"nominal": 0.7, "low": 0.8, "high": 0.9}}
TWICE = {"known": {"winch.radius": 0.02}, "arm": {"winch": {"radius": 0.03}}}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"fit": TURNED}, r"fit\.winch\.efficiency: needs low ≤ nominal"),
        ({"fit": {"winch.efficiency": {"nominal": 0.7}}}, r"fit\.winch\.efficiency\.low: Field"),
        ({"fit": {"winch.efficiency": 0.7}}, r"fit\.winch\.efficiency: "),
        ({"fit": [0.7]}, "fit: a list of names, or a mapping"),
        ({"fit": "winch.efficiency"}, "fit: Input should be a valid dictionary"),
        ({"fit": []}, "fit: name at least one number"),
        ({"fit": ["winch.efficiency"], "known": {"winch.efficiency": 0.7}}, "either known or fitt"),
        ({"known": dict.fromkeys(FITTED, 0.7)}, "known: nothing is left to fit"),
        (TWICE, r"winch\.radius: either in 'known' or in 'arm'"),
        (
            {"time": {"column": "left current", "unit": "s"}},
            "left.effort: 'left current' is the column",
        ),
        ({"arm": {"winch": 3}}, "arm: winch: a mapping of its numbers, got 3"),
    ],
)
def test_a_mistake_is_a_sentence_with_its_place(tmp_path, changes, sentence):
    with pytest.raises(ConfigError, match=sentence):
        load_rig(write(tmp_path, **changes))


def test_a_number_beyond_its_range_ends_the_command_with_a_sentence(tmp_path, logs, capsys):
    path = write(tmp_path, fit=WIDE)
    order = ["--train", *map(str, logs[:3]), "--test", str(logs[3]), "--out", str(tmp_path / "o")]
    assert main(["diagnose", "--rig", str(path), *order]) == 2
    said = capsys.readouterr().err.strip().splitlines()
    assert said[-1].endswith("0.6 to 1 1 (torque transmitted by the gear)")
    assert not (tmp_path / "o").exists()
