"""The same log as CSV, Parquet or MCAP is the same to the diagnosis."""

import numpy as np
import pandas as pd
import pytest

from spirob.errors import DataError, MissingLog
from spirob.logs import read_log
from spirob.machine.reading import read_columns
from tests.bench.fake_robot import FakeRobot
from tests.bench.trials import record_on

TABLE = pd.DataFrame({"t": np.arange(5) * 0.1, "q": [1.5, 2.0, -3.0, 4.0, 0.25]})


def test_parquet_and_csv_give_the_same_columns(tmp_path):
    TABLE.to_csv(tmp_path / "a.csv", index=False)
    TABLE.assign(name=["x"] * 5, step=range(5)).to_parquet(tmp_path / "a.parquet")
    text, _ = read_columns(tmp_path / "a.csv")
    table, _ = read_columns(tmp_path / "a.parquet")
    assert set(table) == {"t", "q", "step"}  # words are no signal
    for name in text:
        np.testing.assert_allclose(text[name], table[name])


def test_our_own_logs_give_their_channels(tmp_path):
    path = record_on(FakeRobot(), tmp_path)
    columns, _ = read_columns(path)
    trace = read_log(path)
    np.testing.assert_array_equal(columns["left.current"], trace["left.current"])
    assert columns["time"][0] == 0.0
    assert np.all(np.diff(columns["time"]) > 0)


def test_what_is_no_log_is_refused(tmp_path):
    (tmp_path / "a.parquet").write_bytes(b"PAR1 no table")
    (tmp_path / "a.mcap").write_bytes(b"no log")
    (tmp_path / "a.xls").write_bytes(b"")
    for name in ("a.parquet", "a.mcap", "a.xls"):
        with pytest.raises(DataError, match=name[:2]):
            read_columns(tmp_path / name)
    with pytest.raises(MissingLog):
        read_columns(tmp_path / "absent.csv")
