"""The shares of the wraps: together what one process plays, and refused where some are missing."""

import shutil
from pathlib import Path

import pandas as pd
import pytest

from pipeline import config as configured
from pipeline.stage import public_config, write_json
from pipeline.trials import paper_wraps, train_wraps
from pipeline.wraps import SHARES, share, together, wrapped
from spirob.errors import ConfigError, MissingLog

ROOT = Path(__file__).parents[2]
MODEL = {"effects": [], "changes": {}}


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """All wraps of the short preset, in three shares; the last is played first."""
    root = tmp_path_factory.mktemp("wraps")
    configured.write(root, configured.composed(ROOT, ["perceive=short"]), "conf")
    write_json(root / "data/diagnosis/model.json", MODEL)
    for part in (2, 0, 1):
        share(root, part, 3)
    return root


def test_shares_have_the_bits_of_one_run(project):
    config = public_config(project)
    whole = wrapped(config, MODEL, train_wraps(config), training=True)
    pd.testing.assert_frame_equal(together(project, config), whole, check_exact=True)


def test_drawn_wraps_are_played_by_other_machines_and_listed_ones_by_the_model(project):
    config = public_config(project)
    played = together(project, config)
    alike = wrapped(config, MODEL, train_wraps(config))
    listed = len(paper_wraps(config))
    pd.testing.assert_frame_equal(played[:listed], alike[:listed], check_exact=True)
    features = [name for name in played if name != "diameter"]
    assert (played[features][listed:] != alike[features][listed:]).any(axis=1).all()
    assert played["diameter"].equals(alike["diameter"])


def test_a_missing_share_is_told(project, tmp_path):
    shutil.copytree(project, tmp_path, dirs_exist_ok=True)
    config = public_config(tmp_path)
    (tmp_path / SHARES / "001_of_003.parquet").unlink()
    wraps = len(train_wraps(config))
    with pytest.raises(
        MissingLog, match=rf"data/wraps holds \d wraps .* asks for {wraps}.*'wraps'"
    ):
        together(tmp_path, config)


def test_shares_of_two_divisions_do_not_mix(project, tmp_path):
    shutil.copytree(project, tmp_path, dirs_exist_ok=True)
    share(tmp_path, 0, 2)
    with pytest.raises(MissingLog, match="or others; empty it"):
        together(tmp_path, public_config(tmp_path))


def test_more_shares_than_wraps_are_empty(project, tmp_path):
    shutil.copytree(project, tmp_path, dirs_exist_ok=True)
    shutil.rmtree(tmp_path / SHARES)
    share(tmp_path, 40, 50)
    assert not (tmp_path / SHARES).exists()


@pytest.mark.parametrize(("part", "parts"), [(3, 3), (-1, 3), (0, 0)])
def test_a_share_that_is_not_there_is_refused(project, part, parts):
    with pytest.raises(ConfigError, match="counted from 0"):
        share(project, part, parts)
