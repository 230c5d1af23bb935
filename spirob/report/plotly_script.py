"""plotly.js without the address of any other host.

The library names map servers, a chart editor and its own home page.  The page draws nothing of the
kind, so those addresses are made unusable; what is left are XML namespaces, which are names and
never fetched.  They are written with escaped slashes, the same string to JavaScript, so that the
finished page can be checked by searching it for '://'.
"""

import re
from functools import cache

from plotly.offline import get_plotlyjs

NAMESPACE = re.compile(r"(https?:)//(?=www\.w3\.org/)")
ADDRESS = re.compile(r"https?://")
OFFLINE = "offline:"


@cache
def plotly_script() -> str:
    """The library, to be inlined once."""
    return ADDRESS.sub(OFFLINE, NAMESPACE.sub(r"\1\\/\\/", get_plotlyjs()))
