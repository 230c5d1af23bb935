"""MuJoCo's C functions, callable from compiled code and, with the JIT off, from Python.

numba resolves them as external symbols of the library that the `mujoco` wheel ships, so that the
compiled loop can be cached on disk and runs without the GIL.  Models and data are passed by
address, arrays by the address of their first element.
"""

import ctypes
import glob
import os

import llvmlite.binding as llvm
import mujoco
import numba
from numba import types

from spirob.errors import SimulationError

_ADDRESS = types.intp
_SIGNATURES = {
    "mj_step1": (types.void(_ADDRESS, _ADDRESS), [ctypes.c_void_p] * 2),
    "mj_step2": (types.void(_ADDRESS, _ADDRESS), [ctypes.c_void_p] * 2),
    "mj_solveM": (
        types.void(_ADDRESS, _ADDRESS, _ADDRESS, _ADDRESS, types.intc),
        [ctypes.c_void_p] * 4 + [ctypes.c_int],
    ),
}


def _library() -> str:
    folder = os.path.dirname(mujoco.__file__)
    names = ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll")
    found = [path for name in names for path in sorted(glob.glob(os.path.join(folder, name)))]
    if not found:
        raise SimulationError(f"the mujoco package holds no library ({', '.join(names)})")
    return found[0]


def functions() -> dict[str, object]:
    """`mj_step1`, `mj_step2`, `mj_solveM` for the generated loop."""
    path = _library()
    if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
        library = ctypes.CDLL(path)
        plain = {}
        for name, (_, arguments) in _SIGNATURES.items():
            function = getattr(library, name)
            function.argtypes, function.restype = arguments, None
            plain[name] = function
        return plain
    llvm.load_library_permanently(path)
    return {n: types.ExternalFunction(n, signature) for n, (signature, _) in _SIGNATURES.items()}
