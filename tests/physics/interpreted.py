"""Play one trial without the JIT and save it: run as a module with NUMBA_DISABLE_JIT=1."""

import sys

import numpy as np

from tests.physics.test_compiled import EFFECTS, play

if __name__ == "__main__":
    import numba

    assert numba.config.DISABLE_JIT
    np.savez(sys.argv[1], **{f"{n}_{k}": v for n in EFFECTS for k, v in play(n).items()})
