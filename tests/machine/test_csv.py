"""Any CSV is read as it was meant, or refused in a sentence; never a crash, never a hang."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spirob.errors import DataError
from spirob.machine.csv_table import read_csv

ROWS = [[0.0, 1.5, -2e-3], [0.001, 2.25, 4.0], [0.002, 3.0, 1234.5], [0.003, -4.0, 0.125]]


def written(path, separator, decimal, head="t{0}q{0}u"):
    lines = [head.format(separator)]
    lines += [separator.join(f"{v:.6f}".replace(".", decimal) for v in row) for row in ROWS]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("separator", [",", ";", "\t", "|", " "])
@pytest.mark.parametrize("decimal", [".", ","])
def test_separator_and_decimal_sign_are_found(tmp_path, separator, decimal):
    if separator == decimal:
        pytest.skip("a comma cannot be both")
    columns, said = read_csv(written(tmp_path / "a.csv", separator, decimal))
    np.testing.assert_allclose(np.column_stack([columns[n] for n in "tqu"]), ROWS, atol=1e-9)
    assert bool(said) == ((separator, decimal) != (",", "."))


def test_comments_bom_and_windows_line_ends(tmp_path):
    text = "# made by a drive\r\nt,q\r\n" + "\r\n".join(f"{k},{2 * k}" for k in range(5))
    path = tmp_path / "a.csv"
    path.write_bytes(b"\xef\xbb\xbf" + text.encode())
    columns, _ = read_csv(path)
    assert list(columns) == ["t", "q"]
    np.testing.assert_array_equal(columns["q"], [0, 2, 4, 6, 8])


def test_a_file_without_names_says_so(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("\n".join("1,2,3" for _ in range(10)))
    with pytest.raises(DataError, match="must name the columns"):
        read_csv(path)


def test_a_name_over_two_columns_is_said(tmp_path):
    columns, said = read_csv(written(tmp_path / "a.csv", ",", ".", head="t{0}q{0}q"))
    np.testing.assert_allclose(columns["q"], [row[1] for row in ROWS], atol=1e-9)
    assert said == ["a.csv: 2 columns are called 'q'; the first is used."]


@settings(
    max_examples=150, deadline=2000, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.binary(max_size=400))
def test_any_bytes_give_columns_or_a_sentence(tmp_path, content):
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    try:
        columns, _ = read_csv(path)
    except DataError as error:
        assert str(path) in str(error)
    else:
        assert all(values.dtype == float for values in columns.values())


CELL = st.one_of(
    st.floats(allow_nan=True).map(repr),
    st.integers().map(str),
    st.text(alphabet="abc,.;\"' \t#\n-+eE0", max_size=6),
)


@settings(
    max_examples=150, deadline=2000, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    st.lists(st.lists(CELL, min_size=1, max_size=4), min_size=1, max_size=12),
    st.sampled_from(",;\t| "),
)
def test_any_table_gives_columns_or_a_sentence(tmp_path, rows, separator):
    path = tmp_path / "a.csv"
    path.write_text("\n".join(separator.join(row) for row in rows), encoding="utf-8")
    try:
        read_csv(path)
    except DataError as error:
        assert len(str(error)) > len(str(path))
