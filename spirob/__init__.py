"""Model, measure and diagnose tendon-driven robots through their motor currents."""

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
