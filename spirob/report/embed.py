"""Data and plotly.js inside the page: packed, and free of what an HTML parser can mistake.

Signals as 16-bit integers in base64: a quarter of the size of a double, finer than a pixel.

A packed signal is {"low", "step", "data"}; sample = low + step·(integer + 32767), and the integer
-32768 stands for a missing sample.  A small change of another signal does with 8 bits, "coarse":
low + step·(integer + 127), -128 missing.  `assets/packing.js` is the other half.

plotly.js names no other host here.  The library names map servers, a chart editor and its own home
page.  The page draws nothing of the kind, so those addresses are made unusable; what is left are
XML namespaces, which are names and never fetched.  They are written with escaped slashes, the same
string to JavaScript, so that the finished page can be checked by searching it for '://'.
"""

import base64
import json
import re
from functools import cache
from typing import Any

import numpy as np
from markupsafe import Markup
from plotly.offline import get_plotlyjs


def json_script(name: str, value: Any) -> Markup:
    """`value` as a script element of type JSON with the id `name`."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    text = text.replace("</", "<\\/").replace("<!--", "<\\u0021--")
    return Markup(f'<script type="application/json" id="{name}">{text}</script>')


FINE, COARSE = np.dtype("<i2"), np.dtype("i1")


def pack(signal: np.ndarray, coarse: bool = False) -> dict[str, Any] | None:
    """Pack one signal; None when it holds no finite sample."""
    signal = np.asarray(signal, float)
    finite = np.isfinite(signal)
    if not finite.any():
        return None
    kind = COARSE if coarse else FINE
    most = int(np.iinfo(kind).max)
    low, high = float(signal[finite].min()), float(signal[finite].max())
    step = (high - low) / (2 * most) or 1.0
    level = np.full(signal.shape, -most - 1, kind)
    level[finite] = np.round((signal[finite] - low) / step) - most
    data = base64.b64encode(level.tobytes()).decode("ascii")
    return {"low": low, "step": step, "data": data} | ({"coarse": True} if coarse else {})


def unpack(packed: dict[str, Any]) -> np.ndarray:
    """The signal again, to within half a step."""
    kind = COARSE if packed.get("coarse") else FINE
    most = np.iinfo(kind).max
    level = np.frombuffer(base64.b64decode(packed["data"]), kind).astype(float)
    level[level == -most - 1] = np.nan
    return np.asarray(packed["low"] + packed["step"] * (level + most))


def stride(samples: int, most: int) -> int:
    """Keep every so-many-th sample so that at most `most` are left."""
    return max(1, -(-samples // most))


NAMESPACE = re.compile(r"(https?:)//(?=www\.w3\.org/)")
ADDRESS = re.compile(r"https?://")
OFFLINE = "offline:"


@cache
def plotly_script() -> str:
    """The library, to be inlined once."""
    return ADDRESS.sub(OFFLINE, NAMESPACE.sub(r"\1\\/\\/", get_plotlyjs()))
