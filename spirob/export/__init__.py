"""Take the corrected model home: a diagnosis as files that other programs run.

One file in `targets/` for each target; a new file there is a new target, no list names it:

    HOLDS, LACKS   what it can and cannot hold, each a line
    LOSSY          whether it may lose something; it is then always played, where it can be
    files(model)   name of each file -> its text
    arm(model)     the same of the arm, where the target can hold it
    play(folder, about, given)
                   logs played in what was written, arrays by name, where anything can run it; it
                   imports nothing of ours

They load what they need when they write or play.

What is exported:
    corrected.py    the corrected model of a rig;  arm.py  of the arm, each motor an axis
    law.py          an effect as its file states it;  translate.py  its arithmetic, checked, as C
As equations:
    axis.py         those of a plain axis, of axis_text.py and the kernels
    code.py         the same as C99 and as a Python module; of an arm's motors, as C99
As a MuJoCo model:
    body.py         the machine, or the arm alone
    arm_mujoco.py   the arm with winches and tendons; its coupled loop as a Python module
    native.py       effects that MuJoCo holds by itself
And its proof:
    exporting.py    writes the files, each whole or not at all, and proves them
    heldout.py      held-out logs of a rig, or trials of an arm, played in what was written
    targets/        runs a target's `play` where this project cannot be imported
"""

import importlib
import pkgutil
import textwrap
from functools import cache
from types import ModuleType

from spirob.export import targets as _targets

PAD = " " * 11


@cache
def targets() -> dict[str, ModuleType]:
    """The targets by name."""
    found = [info.name for info in pkgutil.iter_modules(_targets.__path__)]
    return {name: importlib.import_module(f"{_targets.__name__}.{name}") for name in found}


def listed() -> str:
    """The targets with what each can and cannot hold."""
    lines = []
    for name, target in targets().items():
        for text, first in ((f"holds {target.HOLDS};", name), (f"not {target.LACKS}", "")):
            lines += textwrap.wrap(text, 78, initial_indent=f"  {first:<8} ", subsequent_indent=PAD)
    return "\n".join(lines)
