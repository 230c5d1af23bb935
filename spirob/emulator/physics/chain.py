"""The arm's linear system, solved: along the chain, or as a whole where turns touch.

The matrix of the linearly implicit step is symmetric and, below the diagonal, of low rank plus
one sub-diagonal:

    H_ij = u_i·v_j  (i > j)   + sub_i [i = j+1],      H_ii = diagonal_i

(two columns for inertia and contact, one for the guide friction of each tendon).  Its Cholesky
factor keeps that form, in a number of operations that grows only linearly, L_ij = (u_i, [i =
j+1])·y_j, with

    l_j² = H_jj - ū_jᵀ P_j ū_j       y_j = (v̄_j - P_j ū_j)/l_j       P_{j+1} = P_j + y_j y_jᵀ

where ū = (u, 1), v̄ = (v, sub) and the last row and column of P live for one hinge only.
Source: Vandebril, Van Barel, Mastronardi, "Matrix Computations and Semiseparable Matrices".

A force between two units acts on the angles between them alone, so its stiffness is a block of the
matrix H of the linearly implicit step,

    H += h κ J Jᵀ,      J_m ≠ 0 for i ≤ m ≤ j

which has not the form above.  So while turns press on each other the matrix is
written out, and is factorised as UᵀU in 48³/3 operations: a cycle of such steps costs twice as much
as one of others.

A diagonal that bounds each block, diag(|J|Σ|J|) ≥ J Jᵀ, would keep the form, and is stable as well.
But it is an inertia that is not there, for friction that still creeps 40 g for each newton, times
up to the number of hinges between: in steps of 0.1 ms it holds tips that slide along a flank
(docs/lab/emulator.md).
"""

import numpy as np

from spirob.emulator.physics import HINGES, compiled

RANK = 4
NUMBERS: dict[str, tuple[int, ...]] = {}
STATE: dict[str, tuple[int, ...]] = {}
SCRATCH = {
    "u": (HINGES, RANK),
    "v": (HINGES, RANK),
    "sub": (HINGES,),  # sub[i] stands left of the diagonal in row i
    "diagonal": (HINGES,),
    "y": (HINGES, RANK),
    "y_sub": (HINGES,),
    "pivot": (HINGES,),
    "whole": (HINGES, HINGES),  # upper triangle of H, then of its factor U
}


@compiled
def factorise(w):
    """Turn u, v, sub, diagonal into the factor y, y_sub, pivot; False where not positive."""
    p = np.zeros((RANK, RANK))
    cross = np.zeros(RANK)
    corner = 0.0
    pu = np.empty(RANK)
    for j in range(HINGES):
        square = w.diagonal[j] - corner
        for a in range(RANK):
            total = cross[a]
            for b in range(RANK):
                total += p[a, b] * w.u[j, b]
            pu[a] = total
            square -= w.u[j, a] * (total + cross[a])
        if not square > 0.0:
            return False
        pivot = np.sqrt(square)
        w.pivot[j] = pivot
        below = w.sub[j + 1] / pivot if j + 1 < HINGES else 0.0
        w.y_sub[j] = below
        corner = below * below
        for a in range(RANK):
            w.y[j, a] = (w.v[j, a] - pu[a]) / pivot
        for a in range(RANK):
            cross[a] = below * w.y[j, a]
            for b in range(RANK):
                p[a, b] += w.y[j, a] * w.y[j, b]
    return True


@compiled
def solve(w, b):
    """Overwrite b with H⁻¹b."""
    c = np.zeros(RANK)
    carry = 0.0
    for i in range(HINGES):
        total = b[i] - carry
        for a in range(RANK):
            total -= w.u[i, a] * c[a]
        total /= w.pivot[i]
        b[i] = total
        carry = w.y_sub[i] * total
        for a in range(RANK):
            c[a] += w.y[i, a] * total
    c[:] = 0.0
    carry = 0.0
    for k in range(HINGES):
        j = HINGES - 1 - k
        total = b[j] - w.y_sub[j] * carry
        for a in range(RANK):
            total -= w.y[j, a] * c[a]
        total /= w.pivot[j]
        b[j] = total
        carry = total
        for a in range(RANK):
            c[a] += w.u[j, a] * total


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
