"""Model, measure and diagnose tendon-driven robots through their motor currents.

`spirob.diagnose(rig, train, test)` goes from a machine's description and logs to what its model
misses; all else is imported from its own module.

The rooms are named in README.md.  Files that stand beside them, from the lowest:
errors.py                      every mistake of a user has a class and a sentence
files.py, plain_yaml.py        what is read, and what is written whole or not at all
ending.py, progress.py         how processes end, and how far a search is
units.py, parameter.py         units of a file; bounded numbers
ports.py                       where effects act
can_protocol.py, robot.py      frames on the bus; what all robots have in common
geometry.py, unit_table.py     what an arm is, by its drawing or as it was measured
control.py                     what a trial asks of each motor in a cycle
"""

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from spirob.machine.diagnosis import diagnose

__all__ = ["diagnose"]
__version__ = "0.1.0"

if sys.version_info < (3, 11):  # noqa: UP036 (a clone on an old Python is told so)
    raise ImportError("spirob needs Python 3.11 or newer; this is " + sys.version.split()[0])


def __getattr__(name: str) -> Any:
    """`spirob.diagnose` is loaded where it is first asked for: the command line stays quick."""
    if name == "diagnose":
        return import_module("spirob.machine.diagnosis").diagnose
    raise AttributeError("module 'spirob' has no attribute " + repr(name))


def __dir__() -> list[str]:
    """What is there, with what is loaded when it is first asked for."""
    return sorted({*globals(), *__all__})
