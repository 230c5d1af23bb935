"""What every reader gives: columns of numbers, and what was not plain about the file."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from spirob.errors import DataError, MissingChannel

EXAMPLE = 40  # characters of a text that are shown


@dataclass(frozen=True)
class Asked:
    """What is to be read.

    wanted  names of the columns that will be used; empty means all
    dbc     what the frames of a CAN log mean
    """

    path: Path
    wanted: tuple[str, ...] = ()
    dbc: Path | None = None

    @property
    def name(self) -> str:
        """The file's name, as it can be printed."""
        return printable(self.path.name)


@dataclass
class Table:
    """A log as columns.

    name     file name, used in every sentence
    columns  name -> (n,) float, n the same for all
    said     sentences: what was not plain about the file
    units    unit of the columns of which the file itself knows it ("s" of dates, of log time);
             it stands above what a description says
    text     name -> an example of what a column holds that holds no numbers
    others   names of what the file holds besides, and that was not read
    """

    name: str
    columns: dict[str, np.ndarray] = field(default_factory=dict)
    said: list[str] = field(default_factory=list)
    units: dict[str, str] = field(default_factory=dict)
    text: dict[str, str] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)

    def column(self, name: str) -> np.ndarray:
        """One column, (n,) float.

        Raises MissingChannel naming what is there, and DataError where the column holds text.
        """
        if name in self.columns:
            return self.columns[name]
        if name in self.text:
            raise DataError(
                f"{self.name}: column '{printable(name)}' holds {self.text[name]}, not numbers "
                "(times: in seconds, or as 2025-01-31 12:00:00.000)"
            )
        raise MissingChannel(self.name, printable(name), [*self.columns, *self.others])

    def say(self, sentence: str) -> None:
        """Add a sentence that begins with the file's name."""
        self.said.append(f"{self.name}: {sentence}")


def printable(name: str) -> str:
    """A name of any bytes as text that every encoding can print."""
    return name.encode("utf-8", "replace").decode("utf-8")


def example(value: object) -> str:
    """A text of a file, cut and in quotes."""
    said = " ".join(printable(str(value)[: 4 * EXAMPLE]).split())
    return f"'{said[:EXAMPLE]}…'" if len(said) > EXAMPLE else f"'{said}'"
