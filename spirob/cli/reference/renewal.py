"""The entry of a module that renews its part of a page in the docs."""

import argparse
from collections.abc import Callable
from pathlib import Path

from spirob.logs.atomic import write_text


def renew(about: str | None, page: Path, renewed: Callable[[str], str]) -> None:
    """Write the page as `renewed` makes it; the command line may name another one."""
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=about, formatter_class=raw)
    parser.add_argument("page", nargs="?", type=Path, default=page, help="(default: %(default)s)")
    chosen = parser.parse_args().page
    write_text(chosen, renewed(chosen.read_text(encoding="utf-8")))
