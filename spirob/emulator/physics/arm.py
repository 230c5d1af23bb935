"""The arm as a planar chain: inertia, gravity, the moment in every hinge; the solver of its step.

With absolute angles φ the kinetic energy is ½ΣA_ij cos(φ_i - φ_j) φ̇_i φ̇_j, where below the
diagonal A_ij = B_i L_j: B_i = m_i c_i + L_i Σ_{k>i} m_k is the first moment of everything that
hangs on hinge i along unit i.  Then

    Σ_j A_ij cos(φ_i - φ_j) φ̈_j = -Σ_j A_ij sin(φ_i - φ_j) φ̇_j² + B_i e'_i·g + moments

with e'_i = (-sin φ_i, cos φ_i).  Because A is separable all sums take one pass over the chain.

Moment of a hinge, u = q - q_rest, x = u/q_stop:

    -k u (1 + a|x|ⁿ) - Σ_m k g_m (u - e_m) - d q̇       ė_m = (u - e_m)/τ_m

(hardening a, n and creep g_m, τ_m are zero in a plain arm), and beyond ±q_stop the faces touch:
a stiff spring with damping.  The damping is kept while faces part (they stick a little, for half
a millisecond): cutting it off there makes a packed arm rattle at the step's own frequency.

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

CREEP_ARMS = 3
RANK = 4  # of the system matrix below its diagonal
NUMBERS = {
    "length": (HINGES,),  # of the units [m]
    "first_moment": (HINGES,),  # B [kg·m]
    "inertia": (HINGES,),  # A_ii [kg·m²]
    "gravity": (2,),  # [m/s²]
    "stiffness": (HINGES,),  # k [N·m/rad]
    "damping": (HINGES,),  # d [N·m·s/rad]
    "rest_angle": (HINGES,),  # q_rest [rad]
    "hardening": (HINGES,),  # a [-]
    "hardening_power": (),  # n [-]
    "creep_share": (CREEP_ARMS, HINGES),  # g [-]
    "creep_time": (CREEP_ARMS,),  # τ [s]
    "stop_angle": (HINGES,),  # [rad]
    "stop_stiffness": (HINGES,),  # [N·m/rad]
    "stop_damping": (HINGES,),  # [N·m·s/rad]
}
STATE = {
    "phi": (HINGES,),  # [rad]
    "rate": (HINGES,),  # [rad/s]
    "creep": (CREEP_ARMS, HINGES),  # e [rad]
}
SCRATCH = {
    "cosine": (HINGES,),
    "sine": (HINGES,),
    "q": (HINGES,),
    "q_rate": (HINGES,),
    "moment": (HINGES,),  # of each hinge at the end of the step if its rate stayed [N·m]
    "implicit": (HINGES,),  # how that moment falls with the new rate, times h [kg·m²]
    "force": (HINGES,),  # generalised force on φ [N·m]
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
def pose(s, w):
    """Sines, cosines, hinge angles and rates of the present state."""
    before = 0.0
    before_rate = 0.0
    for i in range(HINGES):
        w.cosine[i] = np.cos(s.phi[i])
        w.sine[i] = np.sin(s.phi[i])
        w.q[i] = s.phi[i] - before
        w.q_rate[i] = s.rate[i] - before_rate
        before = s.phi[i]
        before_rate = s.rate[i]


@compiled
def inertia(p, w):
    """Start the system matrix with the mass matrix."""
    for i in range(HINGES):
        w.u[i, 0] = -p.first_moment[i] * w.sine[i]
        w.u[i, 1] = p.first_moment[i] * w.cosine[i]
        w.v[i, 0] = -p.length[i] * w.sine[i]
        w.v[i, 1] = p.length[i] * w.cosine[i]
        w.diagonal[i] = p.inertia[i]


@compiled
def weight_and_spin(p, s, w):
    """Start the generalised force with gravity and the velocity terms."""
    x, y = 0.0, 0.0
    for i in range(HINGES):
        c, sn = w.cosine[i], w.sine[i]
        w.force[i] = p.first_moment[i] * (p.gravity[1] * c - p.gravity[0] * sn - (sn * x - c * y))
        square = s.rate[i] * s.rate[i]
        x += p.length[i] * c * square
        y += p.length[i] * sn * square
    x, y = 0.0, 0.0
    for k in range(HINGES):
        i = HINGES - 1 - k
        c, sn = w.cosine[i], w.sine[i]
        w.force[i] -= p.length[i] * (sn * x - c * y)
        square = s.rate[i] * s.rate[i] * p.first_moment[i]
        x += c * square
        y += sn * square


@compiled
def hinges(p, s, w, h):
    """Elastic, creeping, damping and stop moment of every hinge, linearised for the step."""
    for i in range(HINGES):
        u = w.q[i] - p.rest_angle[i]
        rate = w.q_rate[i]
        k = p.stiffness[i]
        harder = 0.0
        if p.hardening[i] > 0.0:
            harder = p.hardening[i] * abs(u / p.stop_angle[i]) ** p.hardening_power
        slope = k * (1.0 + (1.0 + p.hardening_power) * harder)
        moment = -k * u * (1.0 + harder)
        for m in range(CREEP_ARMS):
            share = k * p.creep_share[m, i]
            moment -= share * (u - s.creep[m, i])
            slope += share
        moment -= (h * slope + p.damping[i]) * rate
        implicit = h * slope + p.damping[i]
        side = 1.0 if w.q[i] > 0.0 else -1.0
        beyond = side * w.q[i] - p.stop_angle[i]
        stiff = h * p.stop_stiffness[i] + p.stop_damping[i]
        if beyond > 0.0 or beyond + h * side * rate > 0.0:
            moment -= side * (p.stop_stiffness[i] * beyond + stiff * side * rate)
            implicit += stiff
        w.moment[i] = moment
        w.implicit[i] = h * implicit


@compiled
def creep(p, s, w, h):
    """Let the creeping arms follow; exact for a hinge that stands."""
    for m in range(CREEP_ARMS):
        follow = 1.0 - np.exp(-h / p.creep_time[m])
        for i in range(HINGES):
            if p.creep_share[m, i] > 0.0:
                s.creep[m, i] += follow * (w.q[i] - p.rest_angle[i] - s.creep[m, i])


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
