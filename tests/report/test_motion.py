"""The motion on a rig's page: what is drawn, in which unit, and the guesses beside the models."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from spirob.report.sections.motion import RigMotion, motion_figure, table

TIME = np.arange(0, 2, 0.01)


def score(value, low=None, high=None):
    both = {"rmse": value, "interval": [low, high]}
    return {"window": {"position": both, "speed": both}, "whole": None, "effort": None}


def document():
    roles = {"test": score(0.002, 0.001, 0.003), "train": score(0.004)}
    for role in roles.values():
        role["whole"] = role["window"]
    return {
        "unit": "m",
        "speed_unit": "m/s",
        "effort_unit": "N",
        "horizon": 0.5,
        "rungs": [{"effects": ["coulomb_friction"], **roles}],
        "guesses": [{"name": "standing still", **roles}],
    }


def curves():
    columns = {"trial": "day.csv", "role": "test", "time": TIME, "position": np.sin(TIME)}
    for model, wrong in (("base", 50.0), ("named", 0.01)):
        columns[f"{model}_position_whole"] = np.sin(TIME) + wrong * TIME
        columns[f"{model}_position_window"] = np.sin(TIME) + wrong
    return pd.DataFrame(columns)


def test_models_and_guesses_stand_in_one_table_in_millimetres():
    found = table(document())
    assert [row["label"] for row in found["rows"]][::2] == [
        "fitted numbers + coulomb friction",
        "standing still",
    ]
    assert found["columns"][0] == "position, 0.5 s [mm]"
    assert [row["logs"] for row in found["rows"]][:2] == ["held out", "fitted"]
    assert found["rows"][0]["cells"][0] == ("2.00", "1.00 to 3.00")
    assert found["rows"][1]["cells"][0] == ("4.00", "")


def test_a_model_that_runs_away_leaves_the_measured_motion_to_be_seen():
    figure = motion_figure(curves(), "coulomb friction", "m")
    low, high = figure.layout.yaxis.range
    assert -1100 < low < 0 < 1000 < high < 2100  # mm
    missed = figure.data[-1]
    assert missed.yaxis == "y2"
    np.testing.assert_allclose(missed.y, 10.0, rtol=1e-4)


@pytest.mark.parametrize(
    ("motion", "said"), [(None, "asks for no motion"), ({"absent": "no inertia"}, "no inertia.")]
)
def test_without_a_prediction_it_is_said_why(motion, said):
    data = SimpleNamespace(diagnosis={"motion": motion, "effects": []}, motion=None)
    assert said in RigMotion().get_context(data)["absent"]


def test_each_log_is_drawn():
    diagnosis = {"motion": document(), "effects": [{"name": "coulomb_friction"}]}
    found = RigMotion().get_context(SimpleNamespace(diagnosis=diagnosis, motion=curves()))
    assert [label for label, _ in found["plots"]] == ["day.csv, held out"]
    assert "RMS" in found["sentence"]
