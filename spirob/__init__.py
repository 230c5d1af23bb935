"""Model, measure and diagnose tendon-driven robots through their motor currents."""

import sys

__version__ = "0.1.0"

if sys.version_info < (3, 11):  # noqa: UP036 (a clone on an old Python is told so)
    raise ImportError("spirob needs Python 3.11 or newer; this is " + sys.version.split()[0])
