"""CSV, whatever its separator and decimal sign are."""

import csv
import io
import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from spirob.errors import DataError, NothingLeft
from spirob.logs.readers.columns import Asked, Table, printable, require_room, tell_twice

if TYPE_CHECKING:
    import pandas as pd

KIND = "CSV"
SUFFIXES = {".csv", ".txt", ".tsv", ".dat"}
PLAIN = True

LARGEST = 2**27  # bytes of text, which takes several times as much while it is read
COLUMNS = 5000  # more are no table
UNEVEN = 0.05  # of the rows may have too many cells; more is no table
SAMPLE = 50  # lines from which separator and decimal sign are told
TITLES = 20  # lines that may stand above the line of names
SEPARATORS = (",", ";", "\t", "|", " ")
NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|[+-]?(nan|inf|NaN|NA|null)?")
TIME = re.compile(r"\d{4}-?\d\d-?\d\d([T ].*\d.*)?|\d\d?:\d\d:\d\d([.,]\d+)?")
IGNORED = re.compile(r"^(?:#.*|[ \t]*)\n", re.MULTILINE)
WORDS = {"\t": "tabulators", " ": "blanks"}


def read(asked: Asked) -> Table:
    """Columns by name, and a sentence for whatever was not plain about the file.

    Lines that begin with # are comments, but the last of them may name the columns, as NumPy writes
    it.  Raises DataError where no table of numbers with a line of names can be found.
    """
    from spirob.logs.readers.columns import add

    where, table = printable(str(asked.path)), Table(asked.name)
    text, comment = _text(asked.path, where)
    lines = text.split("\n", SAMPLE + 1)[: SAMPLE + 1]
    if len(lines) > 1 and not lines[-1]:
        lines.pop()
    if len(lines) < 3:
        raise NothingLeft(
            f"{where}: {len(lines)} lines are no table; it takes a line of names, and rows"
        )
    separator, decimal, titles = _dialect(where, lines)
    if titles:
        table.say(f"its first {titles} lines are no table and were left out.")
        text = text.split("\n", titles)[titles]
    names = _cells(lines[titles], separator)
    if _numbers(names):
        if len(_cells(comment, separator)) != len(names):
            raise DataError(f"{where}: the first line holds numbers; it must name the columns")
        names, text = _cells(comment, separator), f"{comment}\n{text}"
    require_room(text.count("\n") - 1, len(names))
    frame, cut = _parse(where, text, separator, decimal)
    for k, name in enumerate(frame.columns):
        add(table, str(name).strip().strip('"'), frame.iloc[:, k])
    tell_twice(table, names)
    if cut:
        table.say("rows have more cells than there are names; those beyond are left out.")
    if lost := text.count("\n") - 1 - len(frame):
        if lost > UNEVEN * len(frame):
            raise DataError(f"{where}: rows of more cells than there are names are {lost}")
        table.say(f"rows of more cells than there are names are left out: {lost}.")
    if (separator, decimal) != (",", "."):
        between = WORDS.get(separator, f"'{separator}'")
        table.say(f"read with {between} between columns and '{decimal}' as decimal sign.")
    return table


def _text(path: Path, where: str) -> tuple[str, str]:
    """The lines that are no comments and not blank, each with one line feed.

    Also the last comment before them.
    """
    if path.stat().st_size > LARGEST:
        raise DataError(f"{where}: more than {LARGEST >> 20} MiB of text; use Parquet")
    text = _decoded(path.read_bytes(), where)
    text = text.replace("\r\n", "\n").replace("\r", "\n").removesuffix("\n") + "\n"
    before: list[str] = []
    for line in text.split("\n", SAMPLE):
        if line.strip() and not line.startswith("#"):
            break
        before += [line.lstrip("# \t")] if line.startswith("#") else []
    return IGNORED.sub("", text), before[-1].strip() if before else ""


def _decoded(content: bytes, where: str) -> str:
    for encoding in ("utf-8-sig", "utf-16"):
        if encoding == "utf-16" and content[:2] not in (b"\xff\xfe", b"\xfe\xff"):
            continue
        try:
            return content.decode(encoding)
        except UnicodeDecodeError:
            continue
    text = content.decode("latin-1")
    if "\0" in text:
        raise DataError(f"{where}: this is no text, so no CSV")
    return text


def _dialect(where: str, lines: list[str]) -> tuple[str, str, int]:
    """Separator and decimal sign, and how many lines stand above the table, such as a logger's.

    Below those the names are no numbers, and blanks, which titles hold too, are tried last.
    """
    if any(lines[0].count(separator) >= COLUMNS for separator in SEPARATORS):
        raise DataError(f"{where}: more than {COLUMNS} columns are no table")
    cells = {separator: [_cells(line, separator) for line in lines] for separator in SEPARATORS}
    below = range(1, min(TITLES, len(lines) - 3) + 1)
    tries = [(0, SEPARATORS), *((k, SEPARATORS[:-1]) for k in below), *((k, (" ",)) for k in below)]
    for closely in (True, False):
        for titles, separators in tries if closely else tries[:1]:
            rows = {separator: cells[separator][titles:] for separator in separators}
            if titles:
                rows = {s: r for s, r in rows.items() if not any(map(NUMBER.fullmatch, r[0]))}
            if found := _told_by(rows, closely):
                return *found, titles
    raise DataError(
        f"{where}: no table of numbers; expected a line of names, then rows with the same "
        "number of cells, separated by comma, semicolon, tabulator or blanks"
    )


def _told_by(tables: dict[str, list[list[str]]], closely: bool) -> tuple[str, str] | None:
    """The separator and decimal sign under which most cells of most columns are numbers.

    tables   separator -> cells of names and of rows
    closely  the first row has as many cells as there are names, too
    """
    best, chosen = 0.0, ("", "")
    for separator, (names, *rows) in tables.items():
        even = [row for row in rows if len(row) == len(names)]
        torn = closely and len(rows[0]) != len(names)
        if len(names) < 2 or len(even) < 0.9 * len(rows) or torn:
            continue
        for decimal in (".", ","):
            if decimal == separator:
                continue
            good = sum(_told(cell, decimal) for row in even for cell in row)
            quality = good / len(rows)
            if quality > best:
                best, chosen = quality, (separator, decimal)
    return chosen if best >= 1.5 else None


def _numbers(cells: list[str]) -> bool:
    """Whether a line holds numbers and times alone."""
    return all(NUMBER.fullmatch(cell) or TIME.fullmatch(cell) for cell in cells)


def _told(cell: str, decimal: str) -> bool:
    """Whether a cell is a number with this decimal sign, or a time."""
    other = "," if decimal == "." else "."
    number = other not in cell and NUMBER.fullmatch(cell) is not None
    return number or TIME.fullmatch(cell) is not None


def _cells(line: str, separator: str) -> list[str]:
    if separator == " ":
        cells = line.split()
    else:
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    return [cell.strip().strip('"') for cell in cells]


def _parse(where: str, text: str, separator: str, decimal: str) -> tuple["pd.DataFrame", bool]:
    """The table, and whether rows were cut."""
    import pandas as pd

    try:
        with warnings.catch_warnings(record=True) as cut:
            warnings.simplefilter("always", pd.errors.ParserWarning)
            frame = pd.read_csv(
                io.BytesIO(text.encode("utf-8", "replace")),
                sep=r"\s+" if separator == " " else separator,
                decimal=decimal,
                skipinitialspace=True,
                on_bad_lines="skip",
                index_col=False,
                low_memory=False,
            )
        return frame, bool(cut)
    except (pd.errors.ParserError, pd.errors.EmptyDataError, ValueError, OverflowError) as error:
        said = " ".join(str(error).split())
        if "out of memory" in said:
            raise MemoryError from None
        said = said.removeprefix("Error tokenizing data. C error: ")[:120]
        raise DataError(f"{where}: no table of numbers: {said}") from error
