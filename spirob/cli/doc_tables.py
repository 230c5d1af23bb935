"""Tables of the docs that are made from the program; `python -m spirob.cli.doc_tables` renews them.

Ports and signals stand in docs/conventions.md, the features of a wrap in docs/size.md, the library
of effects in docs/effects.md, the keys of a diagnosis in docs/result.md, each between two comments,
and the schema of a diagnosis in docs/diagnosis.schema.json; tests hold them against the program.
"""

import argparse
import json
import re
from pathlib import Path

from spirob.diagnosis.schema import Document, keys
from spirob.effects import table
from spirob.files import write_text
from spirob.perceive.features import FEATURES
from spirob.ports import PORTS, SIGNALS


def ports() -> str:
    """Ports and signals as Markdown, in the order of a cycle."""
    head = "| port | unit | combines by | for each | is |\n|---|---|---|---|---|"
    rows = [
        f"| `{name}` | {port.unit} | {port.combine} | {port.each} | {port.meaning} |"
        for name, port in PORTS.items()
    ]
    signal_head = "| signal | unit | for each | is |\n|---|---|---|---|"
    signals = [
        f"| `{name}` | {signal.unit} | {signal.each} | {signal.meaning} |"
        for name, signal in SIGNALS.items()
    ]
    both = ["Where effects act:", "\n".join([head, *rows])]
    both += ["What they may read:", "\n".join([signal_head, *signals])]
    return "\n\n".join(both) + "\n"


def features() -> str:
    """All features as Markdown, kind by kind; the meaning is the first line of each docstring."""
    head = "| kind | feature | unit | is |\n|---|---|---|---|"
    rows = [
        f"| {one.kind} | `{name}` | {one.unit} | {one.meaning.splitlines()[0]} |"
        for name, one in sorted(FEATURES.items(), key=lambda item: item[1].kind)
    ]
    return "\n".join([head, *rows]) + "\n\n"


def schema() -> str:
    """The JSON schema of `diagnosis.json`."""
    made = Document.model_json_schema(by_alias=True)
    return json.dumps(made, indent=1, ensure_ascii=False) + "\n"


SCHEMA = "diagnosis.schema.json"
PAGES = {
    "conventions.md": ("ports", ports),
    "size.md": ("features", features),
    "effects.md": ("effects", table),
    "result.md": ("keys", keys),
}


def renewed(page: str, text: str) -> str:
    """The text of a page of `PAGES` with the table of today."""
    name, made = PAGES[page]
    place = re.compile(rf"(<!-- {name}:[^>]*-->\n).*?(<!-- end of {name} -->)", re.DOTALL)
    return place.sub(lambda found: f"{found[1]}\n{made()}{found[2]}", text)


def main() -> None:
    """Renew all pages."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--docs", type=Path, default=Path("docs"), help="(default: %(default)s)")
    folder = parser.parse_args().docs
    for page in PAGES:
        text = (folder / page).read_text(encoding="utf-8")
        write_text(folder / page, renewed(page, text))
    write_text(folder / SCHEMA, schema())


if __name__ == "__main__":
    main()
