"""Scripts that play logs in what was exported, and `played_alone`, which runs one of them.

Each runs in a process that cannot import this project, and imports nothing of ours.

alone.py                 the script that is started; it loads one of the others
arm.py, arm_led.py       trials of an arm, in plain MuJoCo and in plain MJCF
mujoco.py, bam.py, c.py  logs of a rig, in each of these formats
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from spirob.errors import ExportError

PLAYERS = Path(__file__).parent
ALONE = (
    "import runpy, sys; sys.modules['spirob'] = sys.modules['pipeline'] = None; "
    "sys.argv = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"
)
LONGEST = 3600  # s


def played_alone(
    player: str, folder: Path, about: dict[str, Any], given: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """What a player makes of logs in what was exported to a folder, arrays by name.

    Raises ExportError, with what the player says, where it cannot be played.
    """
    with tempfile.TemporaryDirectory() as place:
        kept, result = Path(place) / "given.npz", Path(place) / "result.npz"
        np.savez(kept, about=json.dumps(about), **given)  # type: ignore[arg-type]
        alone(PLAYERS / "alone.py", player, folder.resolve(), kept, result)
        with np.load(result) as made:
            return dict(made)


def alone(script: Path, *arguments: Path | str) -> None:
    """Run a script that cannot import this project; raises ExportError with what it says."""
    command = [sys.executable, "-I", "-c", ALONE, str(script), *map(str, arguments)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        raise ExportError(f"the exported model did not end within {LONGEST} s") from None
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["nothing"])[-1]
        raise ExportError(f"the exported model cannot be played: {said[:200]}")
