"""The targets, one file each, and one played where this project cannot be imported.

    python -I __init__.py TARGET FOLDER GIVEN.npz RESULT.npz

plays logs in what was exported, by the `play` of the file of its target, as `played_alone` does:
it imports nothing of ours.
"""

import argparse
import json
import runpy
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

ALONE = (
    "import runpy, sys; sys.modules['spirob'] = sys.modules['pipeline'] = None; "
    "sys.argv = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"
)
LONGEST = 3600  # s


def played_alone(
    target: str, folder: Path, about: dict[str, Any], given: "dict[str, np.ndarray]"
) -> "dict[str, np.ndarray]":
    """What a target's `play` makes of logs in what was exported to a folder, arrays by name.

    Raises ExportError, with what it says, where it cannot be played.
    """
    import numpy as np

    with tempfile.TemporaryDirectory() as place:
        kept, result = Path(place) / "given.npz", Path(place) / "result.npz"
        np.savez(kept, about=json.dumps(about), **given)  # type: ignore[arg-type]
        alone(Path(__file__), target, folder.resolve(), kept, result)
        with np.load(result) as made:
            return dict(made)


def alone(script: Path, *arguments: Path | str) -> None:
    """Run a script that cannot import this project; raises ExportError with what it says."""
    from spirob.errors import ExportError

    command = [sys.executable, "-I", "-c", ALONE, str(script), *map(str, arguments)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        raise ExportError(f"the exported model did not end within {LONGEST} s") from None
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["nothing"])[-1]
        raise ExportError(f"the exported model cannot be played: {said[:200]}")


def main() -> None:
    """Play what is given and keep the result."""
    import numpy as np

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("target", help="name of a file beside this one")
    parser.add_argument("folder", type=Path, help="that was exported to")
    parser.add_argument("given", type=Path, help="an .npz: logs to play")
    parser.add_argument("result", type=Path, help="an .npz: what was played")
    asked = parser.parse_args()
    given: dict[str, Any] = dict(np.load(asked.given))
    about = json.loads(str(given.pop("about")))
    target = runpy.run_path(str(Path(__file__).with_name(f"{asked.target}.py")))
    np.savez(asked.result, **target["play"](asked.folder, about, given))


if __name__ == "__main__":
    main()
