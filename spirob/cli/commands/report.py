"""Write the report from the results that are there, and show it.

The page needs no network.  Nothing else is run: `spirob run` brings the results up to date.
"""

import argparse
import sys
from pathlib import Path

HELP = "write the report from the last results; --open shows it"
ORDER = 40


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--open", action="store_true", help="show it in the browser")
    parser.add_argument("--video", action="store_true", help="with the arm rendered by OpenGL")
    parser.add_argument("--out", metavar="FILE", help="else reports/index.html of the project")
    parser.add_argument("--project", metavar="DIR", help="its folder; else the nearest above")


def run(arguments: argparse.Namespace) -> int:
    """Build the page and, if asked, open it."""
    from spirob.cli.project import find_project
    from spirob.report import build, load, with_clip

    project = find_project(arguments.project)
    out = Path(arguments.out) if arguments.out else project / "reports/index.html"
    data = load(project)
    build(with_clip(data) if arguments.video else data, out)
    print(f"report: {out}")
    if arguments.open:
        return _show(out)
    return 0


def _show(page: Path) -> int:
    import webbrowser

    if webbrowser.open(page.resolve().as_uri()):
        return 0
    print(f"spirob: no browser was found; open {page} in one", file=sys.stderr)
    return 2
