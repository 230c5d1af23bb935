"""What runs apart may die without taking this process along."""

import os
import resource

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.errors import SpirobError
from spirob.logs.readers import MEMORY, Crashed, apart, read_table


def test_the_answer_comes_back():
    assert apart(divmod, 17, 5) == (3, 2)


def test_an_error_comes_back_as_one():
    with pytest.raises(ValueError, match="invalid literal"):
        apart(int, "x")


def test_a_crash_is_an_error_too():
    with pytest.raises(Crashed, match="brings the reader down"):
        apart(os.abort)


def interrupted():
    raise KeyboardInterrupt


def test_what_would_end_a_process_is_an_error_without_a_trace(capfd):
    with pytest.raises(ValueError, match="KeyboardInterrupt"):
        apart(interrupted)
    assert capfd.readouterr().err == ""


def forked():
    if os.fork() == 0:
        raise ValueError("child")
    return "parent"


def test_a_child_that_is_left_behind_answers_nothing(capfd):
    assert [apart(forked) for _ in range(3)] == ["parent"] * 3
    assert capfd.readouterr().err == ""


def test_memory_is_bounded():
    assert apart(resource.getrlimit, resource.RLIMIT_DATA)[0] <= MEMORY
    with pytest.raises(ValueError, match="takes more than 1024 MiB"):
        apart(bytearray, 2 * MEMORY)
    assert resource.getrlimit(resource.RLIMIT_DATA)[0] != MEMORY


def table(rows=400):
    time = pa.array(np.arange(rows), pa.timestamp("us"))
    return pa.table({"t": time, "a": np.linspace(0, 1, rows), "text": ["x"] * rows})


@pytest.mark.parametrize("compression", ["none", "zstd"])
def test_hostile_parquet_is_refused_or_read_but_takes_nobody_along(compression, tmp_path):
    path = tmp_path / "x.parquet"
    pq.write_table(table(), path, compression=compression)
    whole = path.read_bytes()
    footer = int.from_bytes(whole[-8:-4], "little") + 8

    @settings(max_examples=15, deadline=None)
    @given(
        flips=st.lists(
            st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255)), min_size=1
        ),
        inside=st.sampled_from([len(whole), footer]),  # the whole file, or its description alone
    )
    def holds(flips, inside):
        content = bytearray(whole)
        for at, mask in flips:
            content[len(whole) - inside + int(at * inside)] ^= mask
        path.write_bytes(content)
        try:
            read_table(path)
        except SpirobError as error:
            assert len(str(error)) < 500

    holds()
