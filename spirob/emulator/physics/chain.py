"""Solving the arm's linear system in a number of operations that grows only linearly.

The matrix of the linearly implicit step is symmetric and, below the diagonal, of low rank plus
one sub-diagonal:

    H_ij = u_i·v_j  (i > j)   + sub_i [i = j+1],      H_ii = diagonal_i

(two columns for inertia and contact, one for the guide friction of each tendon).  Its Cholesky
factor keeps that form, L_ij = (u_i, [i = j+1])·y_j, with

    l_j² = H_jj - ū_jᵀ P_j ū_j       y_j = (v̄_j - P_j ū_j)/l_j       P_{j+1} = P_j + y_j y_jᵀ

where ū = (u, 1), v̄ = (v, sub) and the last row and column of P live for one hinge only.
Source: Vandebril, Van Barel, Mastronardi, "Matrix Computations and Semiseparable Matrices".
"""

import numpy as np

from spirob.emulator.physics.compiled import HINGES, compiled

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
