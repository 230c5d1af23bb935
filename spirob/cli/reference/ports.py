"""The ports and signals as tables; `python -m spirob.cli.reference.ports` renews them in the docs.

They stand in docs/conventions.md between two comments, and a test holds them against `PORTS` and
`SIGNALS`.
"""

import re
from pathlib import Path

from spirob.cli.reference.renewal import renew
from spirob.ports import PORTS, SIGNALS

PAGE = Path("docs/conventions.md")
PLACE = re.compile(r"(<!-- ports:[^>]*-->\n).*?(<!-- end of ports -->)", re.DOTALL)


def tables() -> str:
    """Both tables as Markdown, in the order of a cycle."""
    head = "| port | unit | combines by | for each | is |\n|---|---|---|---|---|"
    ports = [
        f"| `{name}` | {port.unit} | {port.combine} | {port.each} | {port.meaning} |"
        for name, port in PORTS.items()
    ]
    signal_head = "| signal | unit | for each | is |\n|---|---|---|---|"
    signals = [
        f"| `{name}` | {signal.unit} | {signal.each} | {signal.meaning} |"
        for name, signal in SIGNALS.items()
    ]
    both = ["Where effects act:", "\n".join([head, *ports])]
    both += ["What they may read:", "\n".join([signal_head, *signals])]
    return "\n\n".join(both) + "\n"


def renewed(text: str) -> str:
    """The page with the tables of today."""
    return PLACE.sub(lambda found: f"{found[1]}\n{tables()}{found[2]}", text)


if __name__ == "__main__":
    renew(__doc__, PAGE, renewed)
