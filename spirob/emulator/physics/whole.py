"""The arm's linear system where turns touch: the matrix as a whole.

A force between two units acts on the angles between them alone, so its stiffness is a block of the
matrix H of the linearly implicit step,

    H += h κ J Jᵀ,      J_m ≠ 0 for i ≤ m ≤ j

which has not the form that chain.py factorises.  So while turns press on each other the matrix is
written out, and is factorised as UᵀU in 48³/3 operations: a cycle of such steps costs twice as much
as one of others.

A diagonal that bounds each block, diag(|J|Σ|J|) ≥ J Jᵀ, would keep the form, and is stable as well.
But it is an inertia that is not there, for friction that still creeps 40 g for each newton, times
up to the number of hinges between: in steps of 0.1 ms it held tips that were sliding along a flank
(docs/emulator.md).
"""

import numpy as np

from spirob.emulator.physics.chain import RANK
from spirob.emulator.physics.compiled import HINGES, compiled

SCRATCH = {"whole": (HINGES, HINGES)}  # upper triangle of H, then of its factor U
NUMBERS: dict[str, tuple[int, ...]] = {}
STATE: dict[str, tuple[int, ...]] = {}


@compiled
def write_out(w):
    """Write H out of its parts u, v, sub and diagonal."""
    for j in range(HINGES):
        w.whole[j, j] = w.diagonal[j]
        for i in range(j + 1, HINGES):
            total = 0.0
            for a in range(RANK):
                total += w.u[i, a] * w.v[j, a]
            w.whole[j, i] = total
        if j + 1 < HINGES:
            w.whole[j, j + 1] += w.sub[j + 1]


@compiled
def add_block(w, lever, first, last, weight):
    """Add weight J Jᵀ, J being `lever` from `first` to `last`."""
    for m in range(first, last + 1):
        share = weight * lever[m]
        for n in range(m, last + 1):
            w.whole[m, n] += share * lever[n]


@compiled
def factorise_whole(w):
    """Turn H into its factor; False where it is not positive."""
    for k in range(HINGES):
        square = w.whole[k, k]
        if not square > 0.0:
            return False
        pivot = np.sqrt(square)
        for j in range(k, HINGES):
            w.whole[k, j] /= pivot
        for i in range(k + 1, HINGES):
            share = w.whole[k, i]
            for j in range(i, HINGES):
                w.whole[i, j] -= share * w.whole[k, j]
    return True


@compiled
def solve_whole(w, b):
    """Overwrite b with H⁻¹b."""
    for k in range(HINGES):
        b[k] /= w.whole[k, k]
        for j in range(k + 1, HINGES):
            b[j] -= w.whole[k, j] * b[k]
    for n in range(HINGES):
        k = HINGES - 1 - n
        total = b[k]
        for j in range(k + 1, HINGES):
            total -= w.whole[k, j] * b[j]
        b[k] = total / w.whole[k, k]
