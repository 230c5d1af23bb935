"""The page of an arm's diagnosis draws the laws of what it names, as that of any rig does."""

import json

import numpy as np
import pandas as pd
import pytest

from spirob.cli.main import main
from spirob.effects import all_effects
from spirob.identify.residual import Residual
from spirob.logs.readers import Table
from spirob.machine.arm import diagnosis
from spirob.machine.arm.replay import arm_trial
from spirob.machine.page_tables import laws
from spirob.plant import Plant
from spirob.report.sections.laws import law_of
from tests.machine.arm.elsewhere import log, rig, write

FRICTION = all_effects()["coulomb_friction"]
TRUE = {"winch.efficiency": 0.7, "coulomb_friction.coulomb_torque": 0.004}
LOGS = (("train", 0), ("train", 1), ("validate", 0), ("heldout", 0))


@pytest.fixture(scope="module")
def held():
    """The residual of a held-out log in which the right motor works."""
    columns = log("heldout", 0, TRUE, [FRICTION])
    trial, _ = arm_trial(Table("log", columns), rig(rows={"minimum_speed": 20.0}), "heldout")
    return Residual(Plant(rig().machine(), [FRICTION]), [trial])


def test_a_law_is_what_the_model_lacks_without_its_effect(held):
    found = laws(held, [FRICTION], TRUE, "m")
    missed = held(TRUE)[held.rows]
    np.testing.assert_allclose(found["law"] - found["shown"], missed, atol=1e-12)
    np.testing.assert_array_equal(found["effort"], held.measured()[held.rows])
    winding = found["velocity"] > 0.01
    assert found["law"][winding].median() > 0.1  # A
    assert found["law"][found["velocity"] < -0.01].median() < -0.05
    drawn = law_of(found, {"effort": "motor current", "unit": "A"})
    assert drawn.against.title == "speed [m/s]"
    assert drawn.accounted > 0.95


def test_without_a_named_effect_there_is_no_law(held):
    assert len(laws(held, [], TRUE, "m")) == 0


def test_the_command_writes_a_page_with_both_plots_of_what_it_names(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(diagnosis, "all_effects", lambda: {FRICTION.name(): FRICTION})
    paths = []
    for role, k in LOGS:
        paths.append(str(tmp_path / f"{role}_{k}.csv"))
        pd.DataFrame(log(role, k, TRUE, [FRICTION])).to_csv(paths[-1], index=False)
    bounds = {"nominal": 0.75, "low": 0.65, "high": 0.9}
    path = write(
        tmp_path,
        fit={"winch.efficiency": bounds, "motor.rotor_damping": None},
        rows={"standstill": "drop"},
    )
    out = tmp_path / "out"
    order = ["--rig", str(path), "--train", *paths[:3], "--test", paths[3], "--out", str(out)]
    assert main(["diagnose", *order, "--quiet"]) == 0
    assert "friction" in capsys.readouterr().out
    found = json.loads((out / "diagnosis.json").read_text())
    assert [effect["name"] for effect in found["effects"]] == ["coulomb_friction"]
    assert any("where the working motor stands" in text for text in found["repairs"])
    page = (out / "index.html").read_text()
    for name in ("law-coulomb_friction", "law-coulomb_friction-itself"):
        assert f'id="{name}"' in page
    assert "The law accounts for" in page
