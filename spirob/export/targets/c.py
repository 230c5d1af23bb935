"""C99: a header and a source that a drive or a controller compiles in."""

import ctypes
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spirob.export.arm import CorrectedArm
    from spirob.export.corrected import Corrected

HOLDS = (
    "the feed-forward (compensate), the forward friction terms and the readings, of every effect"
)
LACKS = "the body of a model file: its load is given by the caller (state.carried)"
LOSSY = False
STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"]


def arm(model: "CorrectedArm") -> dict[str, str]:
    """The same of an arm: a motor each, and the laws of tendons and hinges by themselves."""
    from spirob.export.code import c_files_of_arm

    return c_files_of_arm(model)


def files(model: "Corrected") -> dict[str, str]:
    """Name of each file -> its text."""
    from spirob.export.code import c_files

    return c_files(model)


def compiled(folder, name, into):
    """The exported source as a library."""
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if compiler is None:
        sys.exit("no C compiler (cc, gcc, clang) is here")
    library = Path(into) / "exported.so"
    command = [compiler, *STRICT, "-shared", "-fPIC", "-o", library, folder / f"{name}.c", "-lm"]
    subprocess.run(command, check=True)
    return ctypes.CDLL(str(library))


def efforts(library, name, fields, given):
    """Effort for each row, and the frame's reading of the measured effort."""
    import numpy as np

    state = (ctypes.c_double * len(fields))()
    calls = {}
    for function in ("compensate", "reported", "framed"):
        calls[function] = getattr(library, f"{name}_{function}")
        calls[function].restype = ctypes.c_double
    calls["compensate"].argtypes = [ctypes.c_void_p, *[ctypes.c_double] * 4]
    calls["reported"].argtypes = calls["framed"].argtypes = [
        ctypes.c_void_p,
        ctypes.c_double,
        ctypes.c_double,
    ]
    reset = getattr(library, f"{name}_reset")
    reset.argtypes = [ctypes.c_void_p]
    place = {field: k for k, field in enumerate(fields)}
    rows = [given[n] for n in ("position", "speed", "acceleration", "effort")]
    fed = {"carried": "carried", "payload": "payload", "offset": "offset"}
    fed |= {"weight_x": "along", "weight_y": "across"}
    effort, framed = np.zeros(len(rows[0])), np.zeros(len(rows[0]))
    for k, dt in enumerate(given["steps"]):
        first, last = given["starts"][k], given["starts"][k + 1]
        reset(state)
        state[place["time"]] = given["time"][first]
        for row in range(first, last):
            for field, column in fed.items():
                state[place[field]] = given[column][row]
            q, v, a = (x[row] for x in rows[:3])
            effort[row] = calls["compensate"](state, q, v, a, dt)
    for k, dt in enumerate(given["steps"]):
        first, last = given["starts"][k], given["starts"][k + 1]
        reset(state)
        for row in range(first, last):
            effort[row] = calls["reported"](state, effort[row], dt)
        reset(state)
        for row in range(first, last):
            framed[row] = calls["framed"](state, rows[3][row], dt)
    return effort, framed


def play(folder, about, given):
    """Effort for each row, and the frame's reading of the measured effort."""
    with tempfile.TemporaryDirectory() as into:
        library = compiled(folder, about["name"], into)
        effort, framed = efforts(library, about["name"], about["fields"], given)
    return {"effort": effort, "framed": framed}
