"""Any CSV is read as it was meant, or refused in a sentence; never a crash, never a hang."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spirob.errors import DataError
from spirob.logs.readers import read_table

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
    table = read_table(written(tmp_path / "a.csv", separator, decimal))
    np.testing.assert_allclose(np.column_stack([table.columns[n] for n in "tqu"]), ROWS, atol=1e-9)
    assert bool(table.said) == ((separator, decimal) != (",", "."))


def test_comments_bom_and_windows_line_ends(tmp_path):
    text = "# made by a drive\r\nt,q\r\n" + "\r\n".join(f"{k},{2 * k}" for k in range(5))
    path = tmp_path / "a.csv"
    path.write_bytes(b"\xef\xbb\xbf" + text.encode())
    columns = read_table(path).columns
    assert list(columns) == ["t", "q"]
    np.testing.assert_array_equal(columns["q"], [0, 2, 4, 6, 8])


@pytest.mark.parametrize("before", ["", "# made by a drive\n", "# a,b\n"])
def test_a_file_without_names_says_so(before, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(before + "\n".join("1,2,3" for _ in range(10)))
    with pytest.raises(DataError, match="must name the columns"):
        read_table(path)


@pytest.mark.parametrize("separator", [" ", ","])
def test_names_in_the_last_comment_are_names_as_numpy_writes_them(separator, tmp_path):
    path, head = tmp_path / "a.txt", "a robot\n" + separator.join("tqu")
    np.savetxt(path, ROWS, delimiter=separator, header=head)
    columns = read_table(path).columns
    np.testing.assert_allclose(np.column_stack([columns[n] for n in "tqu"]), ROWS)


@pytest.mark.parametrize("separator", [",", ";", "\t", "|"])
def test_titles_above_the_names_are_left_out_and_said(separator, tmp_path):
    path = written(tmp_path / "a.csv", separator, "." if separator == "," else ",")
    titles = ["Motion logger 2.1", f"Date{separator}2024-05-02", f"Rate{separator}1 kHz", ""]
    path.write_text("\n".join([*titles, path.read_text()]))
    table = read_table(path)
    np.testing.assert_allclose(np.column_stack([table.columns[n] for n in "tqu"]), ROWS, atol=1e-9)
    assert table.said[0] == "a.csv: its first 3 lines are no table and were left out."


def test_names_that_are_too_few_are_no_titles(tmp_path):
    (tmp_path / "a.csv").write_text("\n".join(["t,q", *["1,2,3"] * 20]))
    with pytest.raises(DataError, match="a line of names, then rows with the same number of cells"):
        read_table(tmp_path / "a.csv")


def test_a_quoted_name_may_hold_the_separator(tmp_path):
    table = read_table(written(tmp_path / "a.csv", ",", ".", head='t{0}"current, A"{0}u'))
    np.testing.assert_allclose(table.column("current, A"), [row[1] for row in ROWS])


def test_a_name_over_two_columns_is_said(tmp_path):
    table = read_table(written(tmp_path / "a.csv", ",", ".", head="t{0}q{0}q"))
    np.testing.assert_allclose(table.column("q"), [row[1] for row in ROWS], atol=1e-9)
    assert table.said == ["a.csv: 2 columns are called 'q'; the first is used."]


CLOCKS = [
    ("2023-11-14 22:13:20.{}", "2023-11-14 22:13:21.{}"),
    ("2023-11-14T22:13:20.{}Z", "2023-11-14T22:13:21.{}Z"),
    ("2023-11-14T22:13:20.{}+02:00", "2023-11-14T22:13:21.{}+02:00"),
    ("20231114T221320.{}", "20231114T221321.{}"),
    ("23:59:59.{}", "00:00:00.{}"),
    ("9:59:59.{}", "10:00:00.{}"),
]


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize("separator", [",", ";"])
def test_dates_and_times_of_day_are_seconds_since_the_first(tmp_path, clock, separator):
    stamps = [text.format(f"{k:03d}") for text in clock for k in range(0, 1000, 5)]
    if separator == ";":  # a decimal comma, as Python's logging writes it
        stamps = [stamp.replace(".", ",") for stamp in stamps]
    lines = [f"time{separator}q", *(f"{s}{separator}{k}" for k, s in enumerate(stamps))]
    (tmp_path / "a.csv").write_text("\n".join(lines))
    table = read_table(tmp_path / "a.csv")
    np.testing.assert_allclose(table.column("time"), 0.005 * np.arange(400), atol=1e-9)
    assert table.units == {"time": "s"}
    assert any("seconds since" in sentence for sentence in table.said)


def test_a_date_and_a_time_of_day_may_stand_in_two_columns(tmp_path):
    rows = [f"2023-11-14 22:13:20.{k:03d} {k}.5 1.25" for k in range(100)]
    (tmp_path / "a.txt").write_text("\n".join(["date time q u", *rows]))
    table = read_table(tmp_path / "a.txt")
    np.testing.assert_allclose(table.column("time"), 1e-3 * np.arange(100), atol=1e-9)
    np.testing.assert_array_equal(table.column("q"), np.arange(100) + 0.5)


def test_a_stamp_that_is_missing_is_not_a_number(tmp_path):
    stamps = [f"2023-11-14 22:13:{k:02d}" for k in range(40)]
    stamps[7], stamps[9] = "", "lost"
    (tmp_path / "a.csv").write_text("\n".join(["time,q", *(f"{s},1" for s in stamps)]))
    time = read_table(tmp_path / "a.csv").column("time")
    assert np.flatnonzero(np.isnan(time)).tolist() == [7, 9]
    assert time[-1] == 39.0


def test_numbers_that_look_like_dates_stay_numbers(tmp_path):
    (tmp_path / "a.csv").write_text("day,q\n" + "20231114,1.5\n" * 20)
    assert read_table(tmp_path / "a.csv").column("day")[0] == 20231114


def test_other_dates_are_told_as_text(tmp_path):
    (tmp_path / "a.csv").write_text("time,q,u\n" + "14.11.2023 22:13,1.5,2\n" * 20)
    with pytest.raises(DataError, match=r"'14\.11\.2023 22:13', not numbers \(times: in seconds"):
        read_table(tmp_path / "a.csv").column("time")


def test_rows_that_are_too_long_are_refused_or_cut_and_said(tmp_path):
    rows = ["1,2"] * 60
    (tmp_path / "a.csv").write_text("\n".join(["t,q", *rows, "3,4,5", "6,7"]))
    table = read_table(tmp_path / "a.csv")
    assert table.column("q").tolist() == 60 * [2.0] + [7.0]
    assert table.said == ["a.csv: rows of more cells than there are names are left out: 1."]
    (tmp_path / "a.csv").write_text("\n".join(["t,q", *rows, *(["3,4,5"] * 4)]))
    with pytest.raises(DataError, match="more cells than there are names are 4"):
        read_table(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text("\n".join(["t,q", "3,4,5", *rows]))
    table = read_table(tmp_path / "a.csv")
    assert table.column("q").tolist() == [4.0] + 60 * [2.0]
    assert table.said == [
        "a.csv: rows have more cells than there are names; those beyond are left out."
    ]


def test_a_million_columns_are_refused(tmp_path):
    line = ",".join("a" * 1_000_000)
    (tmp_path / "a.csv").write_text(f"{line}\n{line}\n{line}\n")
    with pytest.raises(DataError, match="more than 5000 columns"):
        read_table(tmp_path / "a.csv")


def test_what_short_rows_lack_is_counted_before_it_is_filled(tmp_path):
    wide = ",".join(map(str, range(4990)))
    names = ",".join(f"c{k}" for k in range(4990))
    (tmp_path / "a.csv").write_text("\n".join([names, *[wide] * 55, *["1"] * 40_000]))
    with pytest.raises(DataError, match="rows of 4990 columns are more than 256 MiB"):
        read_table(tmp_path / "a.csv")


@settings(
    max_examples=150, deadline=2000, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.binary(max_size=400))
def test_any_bytes_give_columns_or_a_sentence(tmp_path, content):
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    try:
        columns = read_table(path).columns
    except DataError as error:
        assert path.name in str(error)
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
        read_table(path)
    except DataError as error:
        assert path.name in str(error)


def test_a_quote_that_never_ends_is_told_in_the_words_of_a_user(tmp_path):
    (tmp_path / "a.csv").write_text('t,q\n1,2\n2,3\n3,"4\n4,5\n5,6\n')
    with pytest.raises(DataError, match="no table of numbers: EOF inside string starting at row 3"):
        read_table(tmp_path / "a.csv")
