"""A trace survives Parquet to the bit, and the same trace gives the same bytes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from spirob.errors import DataError, MissingChannel, MissingLog, SpirobError
from spirob.logs import read_log, read_parquet, write_parquet
from spirob.logs.trace import Trace
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on


@pytest.fixture(scope="module")
def trace(tmp_path_factory):
    return read_log(record_on(FakeRobot(), tmp_path_factory.mktemp("log")))


def test_a_recorded_trial_round_trips(trace, tmp_path):
    write_parquet(trace, tmp_path / "t.parquet")
    back = read_parquet(tmp_path / "t.parquet")
    assert (back.name, back.units, back.meta) == (trace.name, trace.units, trace.meta)
    assert list(back.signals) == list(trace.signals)
    assert back.time_ns.dtype == np.int64
    np.testing.assert_array_equal(back.time_ns, trace.time_ns)
    for channel in trace.signals:
        assert back[channel].tobytes() == trace[channel].tobytes()


@settings(max_examples=30, deadline=None)
@given(values=arrays(np.float64, st.integers(1, 30)))
def test_any_floats_round_trip_to_the_bit(tmp_path_factory, values):
    path = tmp_path_factory.mktemp("p") / "t.parquet"
    write_parquet(Trace("t", np.arange(len(values)), {"a": values}, {"a": "A"}), path)
    assert read_parquet(path)["a"].tobytes() == values.tobytes()


def test_the_same_trace_gives_the_same_bytes(trace, tmp_path):
    write_parquet(trace, tmp_path / "a.parquet")
    write_parquet(trace, tmp_path / "b.parquet")
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()


def test_some_channels_are_enough(trace, tmp_path):
    write_parquet(trace, tmp_path / "t.parquet")
    back = read_parquet(tmp_path / "t.parquet", ["left.current"])
    assert list(back.signals) == ["left.current"]
    with pytest.raises(MissingChannel, match=r"t\.parquet: channel 'tail'"):
        read_parquet(tmp_path / "t.parquet", ["tail"])


def test_a_missing_trace_is_named(tmp_path):
    with pytest.raises(MissingLog, match=r"no\.parquet"):
        read_parquet(tmp_path / "no.parquet")


def test_meta_must_be_plain(tmp_path):
    odd = Trace("odd", np.arange(3), {}, {}, {"scene": object()})
    with pytest.raises(DataError, match="odd: meta"):
        write_parquet(odd, tmp_path / "t.parquet")
    assert not list(tmp_path.iterdir())


@settings(max_examples=100, deadline=None)
@given(at=st.floats(0, 1, exclude_max=True), mask=st.integers(0, 255))
def test_damage_is_refused_in_a_sentence(tmp_path_factory, at, mask):
    trace = Trace("t", np.arange(200), {"a": np.linspace(0, 1, 200)}, {"a": "A"})
    path = tmp_path_factory.mktemp("d") / "t.parquet"
    write_parquet(trace, path)
    content = bytearray(path.read_bytes())
    if mask:
        content[int(at * len(content))] ^= mask
    else:
        content = content[: int(at * len(content))]
    path.write_bytes(content)
    try:
        back = read_parquet(path)
    except SpirobError as error:
        assert "t.parquet" in str(error)
        assert "\n" not in str(error)
    else:
        assert np.array_equal(next(iter(back.signals.values())), trace["a"])
