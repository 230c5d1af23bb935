"""The three records of the compiled step: numbers, state and working room.

Each file of physics declares its own fields; here they become numpy record types, so that
compiled code reads `p.rotor_inertia[m]` and Python reads the same memory by the same name.
"""

import hashlib
from pathlib import Path

import numpy as np

from spirob.emulator.physics import arm, contact, drive, motor, tendon

PARTS = (arm, contact, tendon, drive, motor)


def fingerprint() -> str:
    """Hash of the physics sources.

    Numba's disk cache looks at the file of the cached function only, so a change in a file that
    it imports would go unnoticed.  The hash is the name of a field of the record of numbers,
    thus a part of the entry point's signature, and a change anywhere compiles anew.
    """
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def _record(kind: str, extra: list[tuple[str, str, tuple[int, ...]]]) -> np.dtype:
    fields = [(name, "f8", shape) for part in PARTS for name, shape in getattr(part, kind).items()]
    return np.dtype(fields + extra, align=True)


NUMBERS = _record("NUMBERS", [(f"source_{fingerprint()}", "u1", ())])
STATE = _record("STATE", [])
SCRATCH = _record("SCRATCH", [])
