"""JSON in the shapes that people and libraries write; whatever else it holds is a sentence."""

import json
import tracemalloc

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spirob.errors import DataError, SpirobError
from spirob.logs.readers import read_table

N = 12
T = [round(0.1 * k, 1) for k in range(N)]
Q = [k * k for k in range(N)]
COLUMNS = {"t": T, "q": Q}
ROWS = [{"t": t, "q": q} for t, q in zip(T, Q, strict=True)]
FRAME = pd.DataFrame(COLUMNS)


@pytest.mark.parametrize(
    "document",
    [
        COLUMNS,
        ROWS,
        {"data": COLUMNS},
        {"data": ROWS, "about": {"rate": 10}},
        {"name": "x", "log": {"inner": ROWS}},
        *(json.loads(FRAME.to_json(orient=o)) for o in ("columns", "index", "split", "table")),
    ],
)
def test_columns_and_rows_in_any_shell(tmp_path, document):
    (tmp_path / "a.json").write_text(json.dumps(document))
    table = read_table(tmp_path / "a.json", ["t", "q"])
    np.testing.assert_array_equal(table.column("t"), T)
    np.testing.assert_array_equal(table.column("q"), Q)


def test_what_is_nested_is_named_by_its_place(tmp_path):
    rows = [
        {"t": f"2025-01-31T12:00:{k:02d}Z", "pose": {"x": k}, "joint": [k, -k]} for k in range(N)
    ]
    rows[3]["pose"] = {}
    rows[4]["joint"] = None
    (tmp_path / "a.json").write_text(json.dumps(rows))
    table = read_table(tmp_path / "a.json")
    np.testing.assert_array_equal(table.column("t"), np.arange(N))
    assert table.units == {"t": "s"}
    assert table.column("pose.x")[-1] == N - 1
    assert np.flatnonzero(np.isnan(table.column("pose.x"))).tolist() == [3]
    assert table.column("joint[1]")[-1] == 1 - N


def test_a_row_a_line_and_the_last_may_break_off(tmp_path):
    text = "\n".join(json.dumps(row) for row in ROWS)
    (tmp_path / "a.ndjson").write_text(text + '\n{"t": 1.2, "q"')
    table = read_table(tmp_path / "a.ndjson")
    np.testing.assert_array_equal(table.column("q"), Q)
    assert table.said == ["a.ndjson: the last line breaks off and is left out."]
    (tmp_path / "a.ndjson").write_text(text.replace("}", "", 1))
    with pytest.raises(DataError, match="neither one document nor one for each line"):
        read_table(tmp_path / "a.ndjson")


@pytest.mark.parametrize(
    "text",
    [
        "[" * 100_000,
        '{"a":' * 100_000,
        '{"t": [1, 2, 3], "t": [4, 5, 6]}',
        '"text"',
        "[]",
        "{}",
        "null",
        "",
        "[[], []]",
        '{"c' + '": [1, 2], "c'.join(map(str, range(6000))) + '": [1, 2]}',
    ],
)
def test_what_is_no_table_is_refused(tmp_path, text):
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(DataError, match=r"a\.json") as told:
        read_table(tmp_path / "a.json")
    assert len(str(told.value)) < 600


def short_rows(width, rows):
    """A row of many names, and rows that have none of them."""
    return [{f"c{k}": 1 for k in range(width)}, *[{}] * rows]


@pytest.mark.parametrize(
    "document",
    [
        short_rows(4990, 40_000),
        [{}] * 40_000 + short_rows(4990, 1),
        {f"b{k}": short_rows(400, 8000) for k in range(12)},
    ],
    ids=["first", "last", "many tables"],
)
def test_what_short_rows_lack_is_counted_before_it_is_filled(tmp_path, document):
    (tmp_path / "a.json").write_text(json.dumps(document))
    tracemalloc.start()
    try:
        with pytest.raises(DataError, match=r"rows of \d+ columns are more than 256 MiB"):
            read_table(tmp_path / "a.json")
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 2**30


def test_of_many_names_the_one_that_stands_twice_is_told(tmp_path):
    names = ",".join(f'"{k:x}":1' for k in range(300_000))
    (tmp_path / "a.json").write_text(f'{{{names},"zz":1,"zz":2}}')
    with pytest.raises(DataError, match="'zz' stands twice"):
        read_table(tmp_path / "a.json")


def test_numbers_beyond_all_bounds_are_no_crash(tmp_path):
    (tmp_path / "a.json").write_text('{"t": [1, 2, 3], "q": [1, 2, 1' + "0" * 400 + "]}")
    assert read_table(tmp_path / "a.json", ["t"]).column("t").tolist() == [1, 2, 3]


def test_names_that_no_encoding_can_print_are_replaced(tmp_path):
    (tmp_path / "a.json").write_text('{"\\ud800": [1, 2, 3], "q": ["\\udfff", "x", "y"]}')
    table = read_table(tmp_path / "a.json")
    "".join([*table.columns, *table.text.values()]).encode()


PLAIN = st.recursive(
    st.one_of(st.none(), st.booleans(), st.floats(), st.integers(), st.text(max_size=5)),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(["t", "q", "0", "1", "columns", "data", "index"]), inner, max_size=4
        )
    ),
    max_leaves=25,
)


@settings(
    max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(PLAIN)
def test_any_document_is_a_table_or_a_sentence(tmp_path, plain):
    (tmp_path / "a.json").write_text(json.dumps(plain))
    try:
        table = read_table(tmp_path / "a.json")
    except SpirobError as error:
        assert "a.json" in str(error)
    else:
        assert len({len(values) for values in table.columns.values()}) <= 1


@pytest.mark.parametrize("digits", [19, 400, 6000])
def test_whole_numbers_of_any_length_are_numbers(tmp_path, digits):
    """Beyond what a float holds they are none of a machine, and count as missing."""
    rows = [{"t": k, "q": int("9" * 18) if k else 0} for k in range(3)]
    text = json.dumps({name: [row[name] for row in rows] for name in "tq"})
    (tmp_path / "a.json").write_text(text.replace("9" * 18, "9" * digits))
    found = read_table(tmp_path / "a.json").column("q")
    assert found[0] == 0.0
    assert found[1] == float("9" * digits)


def test_what_is_nested_without_end_is_a_sentence(tmp_path):
    (tmp_path / "a.json").write_text("[" * 100_000 + "]" * 100_000)
    with pytest.raises(DataError, match="it is nested too deeply"):
        read_table(tmp_path / "a.json")
