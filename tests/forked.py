"""Runs `python -m` of modules, each in a process of its own that is forked, not started.

What is imported before are libraries alone, which take most of the time; of the project every
process imports what it needs anew, in its own order.
"""

import json
import os
import runpy
import signal
import sys
import traceback
from contextlib import suppress
from importlib import import_module
from pathlib import Path

LIBRARIES = (  # one that is left out costs time, nothing else
    "cantools",
    "h5py",
    "hydra",
    "joblib",
    "mcap.reader",
    "mujoco",
    "numba",
    "pandas",
    "plotly.graph_objects",
    "pyarrow.parquet",
    "pydantic",
    "rich.progress",
    "scipy.optimize",
    "scipy.signal",
    "scipy.stats",
    "sklearn.ensemble",
    "sklearn.gaussian_process",
    "sklearn.svm",
)
LONGEST = 60  # s


def main() -> None:
    """Run each of the commands, lists of a module and its arguments, in a folder of its number."""
    folder, commands = Path(sys.argv[1]), json.loads(sys.argv[2])
    for name in LIBRARIES:
        with suppress(ImportError):
            import_module(name)
    for k, command in enumerate(commands):
        (folder / str(k) / "empty").mkdir(parents=True)
        child = os.fork()
        if child == 0:
            _become(folder / str(k), *command)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        (folder / str(k) / "code").write_text(str(code))


def _become(folder: Path, module: str, *arguments: str) -> None:
    """The module's program, for what is left of this process."""
    signal.alarm(LONGEST)
    for number, name in ((1, "out"), (2, "err")):
        os.dup2(os.open(folder / name, os.O_WRONLY | os.O_CREAT), number)
    os.chdir(folder / "empty")
    sys.argv, sys.path[0] = [module, *arguments], str(folder / "empty")
    code: object = 0
    try:
        runpy.run_module(module, run_name="__main__", alter_sys=True)
    except SystemExit as end:
        code = end.code or 0
    except BaseException:
        traceback.print_exc()
        code = 1
    if isinstance(code, str):
        print(code, file=sys.stderr)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code if isinstance(code, int) else 1)  # to take all apart takes longer than all else


if __name__ == "__main__":
    main()
