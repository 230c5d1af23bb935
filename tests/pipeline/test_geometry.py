"""Another arm through the pipeline: its table beside the rig, its robot, its wraps and its page."""

import shutil

import pandas as pd
import pytest

from pipeline.config import composed
from pipeline.robots import build
from pipeline.schema import validated
from pipeline.trials import paper_wraps
from spirob.errors import ConfigError
from spirob.geometry import PUBLISHED, Drawing
from spirob.plant import Rig
from spirob.report.arm import apart, payload
from tests.pipeline.project import SHORT, SOURCE
from tests.plant.measuring import rows_of, written

ROWS = rows_of(Drawing.from_mapping({"units": 13, "b": 0.3, "size": 0.5}).arm())
TABLE = "+rig.geometry.table=units.csv"


@pytest.fixture
def root(tmp_path):
    """A project whose folder of rigs holds a table."""
    shutil.copytree(SOURCE / "conf", tmp_path / "conf")
    (tmp_path / "conf/rig/units.csv").write_text(written(ROWS))
    return tmp_path


def test_robot_model_and_wraps_are_of_the_arm_in_the_table(root):
    config = validated(composed(root, [*SHORT, TABLE]), "conf/")
    assert "table" not in config.rig["geometry"]  # the configuration holds all that stages need
    rig = Rig.from_mapping(config.rig)
    assert rig.units == 13
    robot = build(
        config, rig, {"effect": "none", "strength": 1.0, "seed": 1, "build": "as_designed"}
    )
    assert robot.machine.build.arm.length == pytest.approx(rig.geometry.length)
    robot.close()
    placed, usual = (
        paper_wraps(validated(composed(root, [*SHORT, *more]), "conf/"))[0]["scene"]["cylinder"]
        for more in ([TABLE], [])
    )
    shorter = rig.geometry.length / PUBLISHED.length
    assert placed["x"] - usual["x"] == pytest.approx(
        0.67 * (shorter - 1.0) * PUBLISHED.length, abs=1e-9
    )


def test_a_missing_unit_is_a_sentence_with_the_file(root):
    (root / "conf/rig/units.csv").write_text(written(ROWS[:4] + ROWS[5:]))
    with pytest.raises(ConfigError, match=r"units\.csv: unit 4 is missing"):
        composed(root, [TABLE])


def test_the_page_draws_that_arm():
    short = Drawing.from_mapping({"units": 13, "b": 0.3, "size": 0.5})

    def bent(units):
        angles = {f"q{i}": [0.0, 2.0 / units] for i in range(units)}
        return pd.DataFrame({"trial": "a", "time": [0.0, 1.0], **angles})

    drawn = payload(bent(13), bent(48), short)
    lengths = [part["geometry"]["length"] for part in (drawn, drawn["robot"])]
    assert [len(one) for one in lengths] == [13, 48]
    assert [sum(one) for one in lengths] == pytest.approx([232.04] * 2, abs=0.1)
    # each hinge bends where its unit begins: headings are half a unit's bend ahead
    ahead = (2.0 / 13 - 2.0 / 48) / 2
    assert apart(bent(13), bent(48), short).max() < ahead * short.length
