"""Take the corrected model home: a diagnosis as files that other programs run.

One file in `targets/` for each target; a new file there is a new target, no list names it:

    HOLDS, LACKS   what it can and cannot hold, each a line
    PLAYER         script in `players/` that plays logs in what was written; "" where nothing runs
    LOSSY          whether it may lose something; it is then always played, where it can be
    files(model)   name of each file -> its text
    arm(model)     the same of the arm, where the target can hold it
They load what they need when they write.

`law` reads an effect's file, `translate` checks its arithmetic and writes C, `axis` puts the
kernels into the equations of an axis; `exporting` writes the files and proves them.
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
