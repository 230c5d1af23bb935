"""A CSV file as columns of numbers, whatever its separator and decimal sign are."""

import io
import re
from pathlib import Path

import numpy as np
import pandas as pd

from spirob.errors import DataError

LARGEST = 2**31  # bytes
SAMPLE = 50  # lines from which separator and decimal sign are told
SEPARATORS = (",", ";", "\t", "|", " ")
NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|[+-]?(nan|inf|NaN|NA|null)?")
WORDS = {"\t": "tabulators", " ": "blanks"}


def read_csv(path: Path) -> tuple[dict[str, np.ndarray], list[str]]:
    """Columns by name, and a sentence for whatever was not plain about the file.

    Lines that begin with # are comments; a column that holds text is left out.  Raises DataError
    where no table of numbers with a line of names can be found.
    """
    if path.stat().st_size > LARGEST:
        raise DataError(f"{path}: more than {LARGEST >> 30} GiB; use Parquet")
    text = _text(path)
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if len(lines) < 3:
        raise DataError(f"{path}: {len(lines)} lines are no table; a line of names and rows follow")
    separator, decimal = _dialect(path, lines[: SAMPLE + 1])
    frame = _parse(path, "\n".join(lines), separator, decimal)
    columns = {}
    for name in frame.columns:
        values = pd.to_numeric(frame[name], errors="coerce").to_numpy(float)
        if np.isfinite(values).any():
            columns[str(name).strip().strip('"')] = values
    said = []
    names = _cells(lines[0], separator)
    for name in sorted({n for n in names if n and names.count(n) > 1}):
        said.append(
            f"{path.name}: {names.count(name)} columns are called '{name}'; the first is used."
        )
    if (separator, decimal) != (",", "."):
        between = WORDS.get(separator, f"'{separator}'")
        said.append(
            f"{path.name}: read with {between} between columns and '{decimal}' as decimal sign."
        )
    return columns, said


def _text(path: Path) -> str:
    content = path.read_bytes()
    for encoding in ("utf-8-sig", "utf-16"):
        if encoding == "utf-16" and content[:2] not in (b"\xff\xfe", b"\xfe\xff"):
            continue
        try:
            return content.decode(encoding)
        except UnicodeDecodeError:
            continue
    text = content.decode("latin-1")
    if "\0" in text:
        raise DataError(f"{path}: this is no text, so no CSV")
    return text


def _dialect(path: Path, lines: list[str]) -> tuple[str, str]:
    """The separator and decimal sign under which most cells of most columns are numbers."""
    best, chosen = 0.0, ("", "")
    for separator in SEPARATORS:
        names = _cells(lines[0], separator)
        rows = [_cells(line, separator) for line in lines[1:]]
        even = [row for row in rows if len(row) == len(names)]
        if len(names) < 2 or len(even) < 0.9 * len(rows):
            continue
        for decimal in (".", ","):
            if decimal == separator:
                continue
            other = "," if decimal == "." else "."
            good = sum(
                other not in cell and NUMBER.fullmatch(cell) is not None
                for row in even
                for cell in row
            )
            quality = good / len(rows)
            if quality > best:
                best, chosen = quality, (separator, decimal)
    if best < 1.5:
        raise DataError(
            f"{path}: no table of numbers; expected a line of names, then rows with the same "
            "number of cells, separated by comma, semicolon, tabulator or blanks"
        )
    if all(NUMBER.fullmatch(cell) for cell in _cells(lines[0], chosen[0])):
        raise DataError(f"{path}: the first line holds numbers; it must name the columns")
    return chosen


def _cells(line: str, separator: str) -> list[str]:
    cells = line.split() if separator == " " else line.split(separator)
    return [cell.strip().strip('"') for cell in cells]


def _parse(path: Path, text: str, separator: str, decimal: str) -> pd.DataFrame:
    pattern = r"\s+" if separator == " " else separator
    try:
        return pd.read_csv(
            io.StringIO(text),
            sep=pattern,
            decimal=decimal,
            skipinitialspace=True,
            on_bad_lines="error",
            index_col=False,
            low_memory=False,
        )
    except (pd.errors.ParserError, pd.errors.EmptyDataError, ValueError, OverflowError) as error:
        said = " ".join(str(error).split())
        raise DataError(f"{path}: rows differ in their number of cells ({said[:120]})") from error
