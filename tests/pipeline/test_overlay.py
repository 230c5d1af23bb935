"""The finalists' responses stand at the same samples as the overlay's."""

from types import SimpleNamespace

import numpy as np
import pandas as pd

from pipeline.overlay import finalists, overlay
from spirob.identify.residual import Filter

SAMPLES = 3000


class Machine:
    """In place of a residual: answers with its number `level` in every signal."""

    def __init__(self, name):
        signals = {c: np.zeros((SAMPLES, 2)) for c in ("current", "displacement", "velocity")}
        seconds = np.arange(SAMPLES) * 1e-3
        self.trials = [SimpleNamespace(name=name, seconds=seconds, **signals)]
        self.filter = Filter(every=10)

    def respond(self, changes, index):
        whole = np.full((SAMPLES, 2), changes["level"])
        return SimpleNamespace(current=whole, displacement=2 * whole, velocity=3 * whole)


def test_every_finalist_has_every_sample_of_the_overlay(tmp_path):
    machines = {"validate": Machine("one"), "heldout": Machine("two")}
    overlay(tmp_path, machines, {"level": 0.0}, {"level": 1.0})
    finalists(tmp_path, machines, {"creep": {"level": 0.5}, "cogging": {"level": 0.25}})
    drawn = pd.read_parquet(tmp_path / "data/diagnosis/overlay.parquet")
    found = pd.read_parquet(tmp_path / "data/diagnosis/finalists.parquet")
    keys = ["trial", "role", "motor", "time"]
    for name, level in (("creep", 0.5), ("cogging", 0.25)):
        rows = found[found["effect"] == name].reset_index(drop=True)
        pd.testing.assert_frame_equal(rows[keys], drawn[keys])
        assert np.allclose(rows["current"], level)
        assert np.allclose(rows["displacement"], 2 * level)
        assert np.allclose(rows["velocity"], 3 * level)


def test_without_finalists_there_is_no_file(tmp_path):
    machines = {"validate": Machine("one"), "heldout": Machine("two")}
    finalists(tmp_path, machines, {})
    assert not (tmp_path / "data/diagnosis/finalists.parquet").exists()
