"""The features of a wrap as a table, which `python -m spirob.cli.reference.features` renews.

It stands in docs/size.md between two comments, and a test holds it against `FEATURES`.
"""

import re
from pathlib import Path

from spirob.cli.reference.renewal import renew
from spirob.perceive.features import FEATURES

PAGE = Path("docs/size.md")
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
    renew(__doc__, PAGE, renewed)
