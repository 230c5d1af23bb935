"""The features of a wrap as a table, which `python -m spirob.cli.reference.features` renews.

It stands in docs/experiments.md between two comments, and a test holds it against `FEATURES`.
"""

import re
import sys
from pathlib import Path

from spirob.logs.atomic import write_text
from spirob.perceive.features import FEATURES

PAGE = Path("docs/experiments.md")
PLACE = re.compile(r"(<!-- features:[^>]*-->\n).*?(<!-- end of features -->)", re.DOTALL)


def table() -> str:
    """All features as Markdown, kind by kind; the meaning is the first line of each docstring."""
    head = "| kind | feature | unit | is |\n|---|---|---|---|"
    rows = [
        f"| {one.kind} | `{name}` | {one.unit} | {one.meaning.splitlines()[0]} |"
        for name, one in sorted(FEATURES.items(), key=lambda item: item[1].kind)
    ]
    return "\n".join([head, *rows]) + "\n"


def renewed(text: str) -> str:
    """The page with the table of today."""
    return PLACE.sub(lambda found: f"{found[1]}\n{table()}\n{found[2]}", text)


if __name__ == "__main__":
    page = Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE
    write_text(page, renewed(page.read_text(encoding="utf-8")))
