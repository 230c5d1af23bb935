"""Measurements from elsewhere come in in SI, are repaired only where that is certain, and said."""

import json

import numpy as np
import pandas as pd
import pytest
import yaml
from mcap.writer import Writer
from scipy.io import savemat

from spirob.cli.main import main
from spirob.errors import ConfigError, DataError, MissingChannel
from spirob.logs import read_parquet
from spirob.logs.foreign import mapping_from, trace_from
from spirob.logs.readers import Table
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on

N = 400
T = np.arange(N) * 1e-3
X = 0.02 * np.sin(2 * np.pi * 2 * T)
V = 0.02 * 2 * np.pi * 2 * np.cos(2 * np.pi * 2 * T)
AMPS = 0.5 + 0.1 * np.cos(9 * T)
MAP = {
    "name": "lab_run_7",
    "time": {"column": "t", "unit": "ms"},
    "channels": {
        "left.current": {"column": "I [mA]", "unit": "mA"},
        "left.displacement": {"column": "x", "unit": "mm", "sign": -1},
        "left.velocity": {"column": "v", "unit": "m/s"},
    },
    "meta": {"role": "train"},
}


def columns():
    return {"t": 1e3 * T, "I [mA]": 1e3 * AMPS, "x": -1e3 * X, "v": V}


def imported(folder, file, plain=None):
    (folder / "map.yaml").write_text(yaml.safe_dump(plain or MAP, sort_keys=False))
    out = folder / "out.parquet"
    asked = ["import", str(file), "--map", str(folder / "map.yaml"), "--out", str(out)]
    return main(asked), out


def check(trace):
    assert trace.name == "lab_run_7"
    assert dict(trace.units) == {
        "left.current": "A",
        "left.displacement": "m",
        "left.velocity": "m/s",
    }
    np.testing.assert_allclose(trace["left.current"], AMPS, rtol=1e-6)
    np.testing.assert_allclose(trace["left.displacement"], X, atol=1e-9)
    np.testing.assert_allclose(trace["left.velocity"], V, rtol=1e-6)
    np.testing.assert_array_equal(np.diff(trace.time_ns), 1_000_000)


@pytest.mark.parametrize("kind", ["csv", "semicolon", "parquet", "mat"])
def test_a_table_comes_in_in_si(kind, tmp_path):
    file = tmp_path / f"run.{'csv' if kind == 'semicolon' else kind}"
    frame = pd.DataFrame(columns())
    plain = MAP
    if kind == "csv":
        frame.to_csv(file, index=False)
    elif kind == "semicolon":
        frame.to_csv(file, index=False, sep=";", decimal=",")
    elif kind == "parquet":
        frame.to_parquet(file)
    else:
        rest = {"log": {"t": 1e3 * T, "x": -1e3 * X}, "data": np.column_stack([V, 1e3 * AMPS])}
        savemat(file, rest, do_compression=True)
        plain = json.loads(json.dumps(MAP))
        names = {"I [mA]": "data(2)", "x": "log.x", "v": "data(1)"}
        for column in plain["channels"].values():
            column["column"] = names[column["column"]]
        plain["time"]["column"] = "log.t"
    code, out = imported(tmp_path, file, plain)
    assert code == 0
    trace = read_parquet(out)
    check(trace)
    assert trace.meta["imported_from"] == file.name
    assert trace.meta["role"] == "train"


def foreign_mcap(path):
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("Joints", "jsonschema", b"{}")
        joints = writer.register_channel("/joints", "json", schema)
        amps = writer.register_channel("/amps", "json", schema)
        for k in range(N):
            stamp = 1_700_000_000_000_000_000 + 1_000_000 * k
            told = {"joints": [{"position": X[k], "velocity": V[k]}]}
            writer.add_message(joints, stamp, json.dumps(told).encode(), stamp)
            if k % 2 == 0:
                writer.add_message(amps, stamp - 10, json.dumps({"a": AMPS[k]}).encode(), stamp)
        writer.finish()


def test_an_mcap_of_others_comes_in_and_slower_topics_are_held(tmp_path, capsys):
    foreign_mcap(tmp_path / "run.mcap")
    plain = {
        "name": "lab_run_7",
        "channels": {
            "left.displacement": {"topic": "/joints", "field": "joints[0].position", "unit": "m"},
            "left.velocity": {"topic": "/joints", "field": "joints[0].velocity", "unit": "m/s"},
            "left.current": {"topic": "/amps", "field": "a", "unit": "A"},
        },
    }
    code, out = imported(tmp_path, tmp_path / "run.mcap", plain)
    assert code == 0
    trace = read_parquet(out)
    np.testing.assert_array_equal(trace["left.displacement"], X)
    np.testing.assert_array_equal(trace["left.current"], np.repeat(AMPS[::2], 2))
    assert "/amps is held" in capsys.readouterr().err
    assert any("/amps is held" in note for note in trace.meta["notes"])


def test_protobuf_is_read_by_its_own_schema(tmp_path):
    record_on(FakeRobot(), tmp_path, name="ours.mcap")
    plain = {
        "name": "joints",
        "channels": {
            "right.displacement": {
                "topic": "/joint_states",
                "field": "joints[1].position",
                "unit": "m",
            },
            "left.command": {"topic": "/command", "field": "left_current", "unit": "A"},
        },
    }
    code, out = imported(tmp_path, tmp_path / "ours.mcap", plain)
    assert code == 0
    trace = read_parquet(out)
    assert len(trace) == 400
    assert np.ptp(trace["right.displacement"]) > 1e-3


def made(changed=None, plain=None):
    table = Table("run.csv", columns() | (changed or {}))
    return trace_from(table, mapping_from(plain or MAP, "map.yaml")), table.said


def with_time(stamps):
    return made({"t": np.asarray(stamps, float)})


def test_whole_time_needs_no_note():
    trace, notes = made()
    check(trace)
    assert notes == []


def test_a_counter_that_wraps_is_continued_with_a_note():
    plain = MAP | {"time": {"column": "t", "unit": "us"}}
    trace, notes = made({"t": (2.0**32 - 1e5 + 1e6 * T) % 2**32}, plain)
    np.testing.assert_array_equal(np.diff(trace.time_ns), 1_000_000)
    assert any("wrapped once" in note for note in notes)


def test_equal_stamps_missing_stamps_and_gaps_are_said():
    stamps = 1e3 * T
    stamps[100] = stamps[101]
    stamps[200] = np.nan
    stamps[300:] += 50.0
    trace, notes = with_time(stamps)
    assert len(trace) == N - 2
    said = " ".join(notes)
    assert "1 rows without a time" in said
    assert "1 rows left out that share their time" in said
    assert "1 gaps in time, the longest 0.051 s" in said
    assert trace.meta["notes"] == notes


def test_a_row_out_of_place_is_put_in_order_with_a_note():
    stamps = 1e3 * T
    stamps[[50, 51]] = stamps[[51, 50]]
    trace, notes = with_time(stamps)
    assert np.all(np.diff(trace.time_ns) > 0)
    assert "1 rows out of place" in notes[0]


@pytest.mark.parametrize(
    ("stamps", "sentence"),
    [
        (1e3 * T[::-1], "time runs backwards in 399 of 400 rows, first in row 2"),
        (np.full(N, np.nan), "fewer than two rows have a time"),
        (1e30 * T, "beyond what nanoseconds can hold"),
    ],
)
def test_time_that_cannot_be_repaired_is_refused(stamps, sentence):
    with pytest.raises(DataError, match=sentence):
        with_time(stamps)


def channel(name, **changes):
    plain = json.loads(json.dumps(MAP))
    plain["channels"][name] = plain["channels"].get(name, {}) | changes
    return plain


@pytest.mark.parametrize(
    ("plain", "error", "sentence"),
    [
        (
            channel("left.current", unit="A"),
            DataError,
            r"'I \[mA\]' says mA, .* says A",
        ),
        (channel("left.current", unit="mm"), ConfigError, "'mm' is not of the kind of A"),
        (channel("left.current", unit="amp"), ConfigError, "unit 'amp' is unknown; known: s, ms"),
        (channel("left.velocity", unit="mm/s"), DataError, "0.001 times the rate of left.displ"),
        (channel("left.velocity", sign=-1), DataError, "-1 times the rate of left.displacement"),
        (channel("left.current", column="amps"), MissingChannel, "'amps' is missing; present: I"),
        (
            channel("left.current", topic="/a", field="b"),
            ConfigError,
            "either 'column', or 'topic'",
        ),
        (channel("left.current", gain=2), ConfigError, "key 'channels.left.current.gain'"),
        (MAP | {"time": {"column": "t", "unit": "A"}}, ConfigError, "'A' is no unit of time"),
        (MAP | {"name": "../../etc/passwd"}, ConfigError, "key 'name'"),
        (MAP | {"channels": {}}, ConfigError, "key 'channels'"),
        ([1, 2], ConfigError, "the file"),
    ],
)
def test_a_wrong_mapping_is_told_in_a_sentence(plain, error, sentence):
    with pytest.raises(error, match=sentence):
        made(plain=plain)


def test_nothing_is_overwritten_and_a_mistake_is_one_sentence(tmp_path, capsys):
    pd.DataFrame(columns()).to_csv(tmp_path / "run.csv", index=False)
    assert imported(tmp_path, tmp_path / "run.csv")[0] == 0
    assert imported(tmp_path, tmp_path / "run.csv")[0] == 2
    assert "exists already" in capsys.readouterr().err
    (tmp_path / "out.parquet").unlink()
    assert imported(tmp_path, tmp_path / "nowhere.csv")[0] == 2
    assert capsys.readouterr().err.count("\n") == 1
