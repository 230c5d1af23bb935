"""Contact of the arm with itself: a turn of the curled arm lies on the turn before it.

Corners of one unit's outline that enter the outline of another are pushed out the shortest way,

    N = k δ + c δ̇  ≥ 0,         F_t = -μ N v_t / √(v_t² + v_0²)

with the numbers of contact.py and a friction of its own.  Units closer than `APART` never meet:
their faces do, which is the hinges' stop.

A force between units i < j acts on the angles i..j only.  Its stiffness and its friction's secant
are blocks of the system matrix, which is then solved as a whole (whole.py).

Which units may meet within the next millisecond is looked up once in that time.
"""

import numpy as np

from spirob.emulator.physics.compiled import HINGES, compiled
from spirob.emulator.physics.contact import nearest_on_unit
from spirob.emulator.physics.whole import add_block, write_out

APART = 6  # units; six turn by at most 86°
PAIRS = (HINGES - APART) * (HINGES - APART + 1) // 2
MARGIN = 4e-3  # m, that units may come closer within `EVERY`
EVERY = 1e-3  # s
LEAST_TURN = np.pi / 2  # between any two units; an arm that turns less cannot meet itself
NUMBERS = {"self_friction": ()}  # μ between two turns [-]
STATE: dict[str, tuple[int, ...]] = {}
SCRATCH = {
    "pairs": (),  # how many pairs of units may meet
    "pair": (PAIRS, 2),  # i, j
    "base": (HINGES, 4),  # of each unit: x, y [m], vx, vy [m/s]
    "lever_n": (HINGES,),  # how the gap of a contact opens with each angle [m]
    "lever_t": (HINGES,),  # how it slides [m]
    "turn_depth": (),  # deepest penetration [m]
    "touching": (),  # how many contacts between turns push
}


@compiled
def look_round(p, s, w):
    """Note which units may meet soon; `pose` must be up to date."""
    w.pairs = 0.0
    w.turn_depth = 0.0
    least, most = 0.0, 0.0
    for i in range(HINGES):
        least, most = min(least, s.phi[i]), max(most, s.phi[i])
    if most - least < LEAST_TURN:
        return
    _bases(p, s, w)
    count = 0
    for i in range(HINGES - APART):
        for j in range(i + APART, HINGES):
            reach = _radius(p, i) + _radius(p, j) + MARGIN
            x = w.base[j, 0] - w.base[i, 0]
            y = w.base[j, 1] - w.base[i, 1]
            x += 0.5 * (p.length[j] * w.cosine[j] - p.length[i] * w.cosine[i])
            y += 0.5 * (p.length[j] * w.sine[j] - p.length[i] * w.sine[i])
            if x * x + y * y < reach * reach:
                w.pair[count, 0], w.pair[count, 1] = i, j
                count += 1
    w.pairs = count


@compiled
def _radius(p, i):
    """Of the circle round a unit's middle that holds its corners [m]."""
    half = 0.5 * p.length[i]
    one = (p.corner_x[i, 0] - half) ** 2 + p.corner_y[i, 0] ** 2
    other = (p.corner_x[i, 1] - half) ** 2 + p.corner_y[i, 1] ** 2
    return np.sqrt(max(one, other, half * half))


@compiled
def _bases(p, s, w):
    x, y, vx, vy = 0.0, 0.0, 0.0, 0.0
    for i in range(HINGES):
        w.base[i, 0], w.base[i, 1], w.base[i, 2], w.base[i, 3] = x, y, vx, vy
        x += p.length[i] * w.cosine[i]
        y += p.length[i] * w.sine[i]
        vx -= p.length[i] * w.sine[i] * s.rate[i]
        vy += p.length[i] * w.cosine[i] * s.rate[i]


@compiled
def add_turns(p, s, w, h):
    """Add the contacts between turns to the generalised force and to the matrix; True where any."""
    w.touching = 0.0
    if w.pairs == 0.0:
        return False
    _bases(p, s, w)
    for n in range(int(w.pairs)):
        i, j = int(w.pair[n, 0]), int(w.pair[n, 1])
        for corner in range(4):
            _enter(p, s, w, h, j, i, corner)
            _enter(p, s, w, h, i, j, corner)
    return w.touching > 0.0


@compiled
def _enter(p, s, w, h, own, other, corner):
    """One corner of unit `own`, if it lies within unit `other`."""
    end, side = corner // 2, 1.0 if corner % 2 == 0 else -1.0
    cx, cy = p.corner_x[own, end], side * p.corner_y[own, end]
    x = w.base[own, 0] + w.cosine[own] * cx - w.sine[own] * cy
    y = w.base[own, 1] + w.sine[own] * cx + w.cosine[own] * cy
    c, sn = w.cosine[other], w.sine[other]
    dx, dy = x - w.base[other, 0], y - w.base[other, 1]
    lx, ly = c * dx + sn * dy, c * dy - sn * dx
    wide = max(p.corner_y[other, 0], p.corner_y[other, 1])
    if lx <= 0.0 or lx >= p.length[other] or abs(ly) >= wide:
        return
    qx, qy, distance = nearest_on_unit(p, other, lx, ly)
    if distance >= 0.0:
        return
    depth = -distance
    nx, ny = (qx - lx) / depth, (qy - ly) / depth
    nx, ny = c * nx - sn * ny, sn * nx + c * ny
    if own < other:  # the force is told as that on the unit nearer to the tip
        nx, ny = -nx, -ny
    _push(p, s, w, h, min(own, other), max(own, other), x, y, nx, ny, depth)


@compiled
def _push(p, s, w, h, i, j, x, y, nx, ny, depth):
    """Push unit j along n at the point x, y, and unit i back."""
    opens, slides = 0.0, 0.0
    for m in range(i, j + 1):
        # how the point moves on unit j, less how it moves on unit i
        ax, ay = -p.length[m] * w.sine[m], p.length[m] * w.cosine[m]
        if m == j:
            ax, ay = -(y - w.base[j, 1]), x - w.base[j, 0]
        elif m == i:
            ax += y - w.base[i, 1]
            ay -= x - w.base[i, 0]
        along, across = nx * ax + ny * ay, nx * ay - ny * ax
        w.lever_n[m], w.lever_t[m] = along, across
        opens += along * s.rate[m]
        slides += across * s.rate[m]
    stiff = h * p.contact_stiffness + p.contact_damping
    push = p.contact_stiffness * depth - stiff * opens
    w.turn_depth = max(w.turn_depth, depth)
    if push <= 0.0:
        return
    drag = p.self_friction * push / np.sqrt(slides * slides + p.creep_speed**2)
    for m in range(i, j + 1):
        w.force[m] += push * w.lever_n[m] - drag * slides * w.lever_t[m]
    if w.touching == 0.0:
        write_out(w)
    w.touching += 1.0
    add_block(w, w.lever_n, i, j, h * stiff)
    add_block(w, w.lever_t, i, j, h * drag)
