"""A real linear drive: figures of the published model, and the right names from its held-out log.

The data is no part of the project; SPIROB_EMPS is the folder with train.csv and test.csv.
"""

import os
from pathlib import Path

import numpy as np
import pytest

from spirob.machine.diagnosis import diagnose

FOLDER = os.environ.get("SPIROB_EMPS", "")
RIG = Path(__file__).parents[2] / "conf/rig/emps.yaml"
pytestmark = pytest.mark.skipif(
    not (Path(FOLDER) / "train.csv").is_file(),
    reason="the EMPS logs are not here: set SPIROB_EMPS to the folder with train.csv and test.csv",
)


@pytest.fixture(scope="module")
def document():
    folder = Path(FOLDER)
    return diagnose(RIG, [folder / "train.csv"], [folder / "test.csv"]).document


def shares(document, role):
    return [100 * r[role]["rmse"] / document["effort_rms"][role] for r in document["ladder"]]


def test_the_base_model_has_the_published_error(document):
    assert shares(document, "train")[0] == pytest.approx(17.95, abs=0.02)
    assert shares(document, "test")[0] == pytest.approx(17.79, abs=0.02)


def test_dry_friction_is_named_first_and_no_decoy(document):
    names = [rung["effects"] for rung in document["ladder"] if not rung.get("ceiling")]
    assert document["verdict"] == "named"
    assert names[1] == ["coulomb_friction"]
    allowed = {"constant_force", "current_offset", "asymmetric_viscous_friction"}
    assert set(names[-1][1:]) <= allowed
    assert len(names[-1]) >= 2


def test_the_held_out_error_falls_below_six_and_a_half_percent(document):
    grown = [k for k, rung in enumerate(document["ladder"]) if not rung.get("ceiling")]
    assert shares(document, "test")[grown[-1]] <= 6.5


def test_the_moved_mass_is_the_published_one(document):
    mass = document["numbers"]["inertia"]
    assert mass["unit"] == "kg"
    assert mass["value"] == pytest.approx(95.1, rel=0.01)
    assert np.isfinite([mass["low"], mass["high"]]).all()
