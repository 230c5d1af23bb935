"""Scripts that play what was exported, each in a process that cannot import this project."""

import subprocess
import sys
from pathlib import Path

from spirob.errors import ExportError

PLAYERS = Path(__file__).parent / "players"
ALONE = (
    "import runpy, sys; sys.modules['spirob'] = sys.modules['pipeline'] = None; "
    "sys.argv = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"
)
LONGEST = 3600  # s


def alone(script: Path, *arguments: Path) -> None:
    """Run a script that cannot import this project; raises ExportError with what it says."""
    command = [sys.executable, "-I", "-c", ALONE, str(script), *map(str, arguments)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        raise ExportError(f"the exported model did not end within {LONGEST} s") from None
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["nothing"])[-1]
        raise ExportError(f"the exported model cannot be played: {said[:200]}")
