"""Stage `report`: one self-contained page, reports/index.html."""

from pathlib import Path

from pipeline.stage import entry, tell
from spirob.report import build, load


def stage(root: Path) -> None:
    """Build the page from what the other stages wrote."""
    out = root / "reports/index.html"
    build(load(root), out)
    tell(f"wrote {out}")


if __name__ == "__main__":
    entry("report", stage, __doc__)
