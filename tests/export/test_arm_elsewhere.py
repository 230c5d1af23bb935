"""An arm that was logged elsewhere keeps its held-out trials, and its export is played on them."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from spirob.cli.main import main
from spirob.errors import ExportError
from spirob.export.arm import corrected_arm
from spirob.export.corrected import read_document
from spirob.machine.arm.replay import lasting, table_of
from tests.documents import document
from tests.export.test_arm_heldout import COMPILER, arm_of
from tests.logs.hostile import parquet_bomb

FROM = 100  # of the cycles that are compared


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """The folder of such a diagnosis, and the trial that it kept."""
    folder, model = tmp_path_factory.mktemp("elsewhere"), arm_of(["coulomb_friction"])
    (trial,) = model.trials()
    trial = replace(trial, use=np.arange(len(trial.current)) >= FROM)
    told = {
        "format": 1,
        "machine": "arm",
        "rig": {},
        "effects": [e.name() for e in model.effects],
        "changes": model.changes,
        "trials": lasting([trial]),
    }
    said = document(rig="spirob", model=told)
    (folder / "diagnosis.json").write_text(json.dumps(said))
    table_of([trial]).to_parquet(folder / "heldout.parquet")
    return folder, trial


def test_a_trial_is_the_same_again(home):
    folder, trial = home
    (again,) = corrected_arm(read_document(folder / "diagnosis.json"), folder).trials()
    for name in ("current", "displacement", "velocity", "use"):
        assert np.array_equal(getattr(again, name), getattr(trial, name))
    for name in ("mode", "reference", "reference_rate", "current_limit"):
        assert np.array_equal(getattr(again.schedule, name), getattr(trial.schedule, name))
    assert (again.first_angle, again.schedule.held) == (trial.first_angle, None)


@pytest.mark.parametrize("target", ["mujoco", "mjcf", pytest.param("c", marks=COMPILER)])
def test_its_export_is_played(target, home, tmp_path):
    given = ["export", str(home[0]), "--to", target, "--out", str(tmp_path), "--check"]
    assert main(given) == 0
    told = json.loads((tmp_path / "check.json").read_text())
    assert told["ours"] < 1e-9
    assert told["lost"] < (0.05 if target == "mjcf" else 0.01)


def test_a_spoilt_table_is_a_sentence(home, tmp_path):
    folder, _ = home
    table = pd.read_parquet(folder / "heldout.parquet").rename(columns={"use": "used"})
    table.to_parquet(tmp_path / "heldout.parquet")
    document = read_document(folder / "diagnosis.json")
    with pytest.raises(ExportError, match=r"heldout\.parquet: cannot be read \('use'\)"):
        corrected_arm(document, tmp_path)
    parquet_bomb(tmp_path / "heldout.parquet")
    with pytest.raises(ExportError, match="unpacks to more than"):
        corrected_arm(document, tmp_path)
    (tmp_path / "heldout.parquet").unlink()
    with pytest.raises(ExportError, match="no trial of the arm was kept aside"):
        corrected_arm(document, tmp_path).trials()
