"""Contact of the arm: with a round object, and with itself.

The object is a fixed cylinder, a peg on a circle, or a ball.  The outline of a unit is a convex
polygon: its two slanted faces and its outer edge, on each side of the axis.  The point of it
nearest to the cylinder's centre is the one contact point of that unit, exact for a round object.
With depth δ = R - distance and n from the point to the centre

    N = k δ + c δ̇  ≥ 0          on the unit along -n
    F_t = -μ N v_t / √(v_t² + v_0²)     regularised Coulomb friction

Both enter the system matrix: the spring with its stiffness, friction with its secant, which is
dissipative and stable at any step.  v_0 = 1 mm/s is the creep that stands for sticking.

A peg goes round at constant speed.  A ball of mass m gives way within the step, which divides N
by 1 + h (h k + c)/m; what the arm feels of it at the end of the step then moves it.

With itself the arm is in contact where a turn of it lies on the turn before.  Corners of one unit's
outline that enter the outline of another are pushed out the shortest way,

    N = k δ + c δ̇  ≥ 0,         F_t = -μ N v_t / √(v_t² + v_0²)

with the same numbers and a friction of its own.  Units closer than `APART` never meet:
their faces do, which is the hinges' stop.

A force between units i < j acts on the angles i..j only.  Its stiffness and its friction's secant
are blocks of the system matrix, which is then solved as a whole (arm.py).

Which units may meet within the next millisecond is looked up once in that time.
"""

import numpy as np

from spirob.emulator.physics import HINGES, compiled
from spirob.emulator.physics.arm import add_block, write_out

APART = 6  # units; six turn by at most 86°
PAIRS = (HINGES - APART) * (HINGES - APART + 1) // 2
MARGIN = 4e-3  # m, that units may come closer within `EVERY`
EVERY = 1e-3  # s
LEAST_TURN = np.pi / 2  # between any two units; an arm that turns less cannot meet itself
NUMBERS = {
    "cylinder": (4,),  # x, y, radius [m], friction [-]; radius 0: no object
    "orbit": (3,),  # of a peg round x, y: radius [m], speed [rad/s], phase [rad]; 0: no peg
    "ball_mass": (),  # [kg]; 0: no ball
    "corner_x": (HINGES, 2),
    "corner_y": (HINGES, 2),
    "contact_stiffness": (),  # [N/m]
    "contact_damping": (),  # [N·s/m]
    "creep_speed": (),  # v_0 [m/s]
    "self_friction": (),  # μ between two turns [-]
}
STATE = {
    "object": (4,),  # x, y [m], vx, vy [m/s]
}
SCRATCH = {
    "touch": (HINGES, 9),  # arm (2) [m], force (2) [N], stiffness xx, xy, yy [kg], rate (2) [m/s]
    "depth": (),  # deepest penetration [m]
    "pairs": (),  # how many pairs of units may meet
    "pair": (PAIRS, 2),  # i, j
    "base": (HINGES, 4),  # of each unit: x, y [m], vx, vy [m/s]
    "lever_n": (HINGES,),  # how the gap of a contact opens with each angle [m]
    "lever_t": (HINGES,),  # how it slides [m]
    "turn_depth": (),  # deepest penetration [m]
    "touching": (),  # how many contacts between turns push
}


@compiled
def nearest(x, y, ax, ay, bx, by):
    """The point of the segment a-b that is nearest to (x, y)."""
    dx, dy = bx - ax, by - ay
    along = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)
    along = min(max(along, 0.0), 1.0)
    return ax + along * dx, ay + along * dy


@compiled
def nearest_on_unit(p, i, x, y):
    """Point of unit i's outline nearest to (x, y), in its own frame, and the signed distance."""
    side = 1.0 if y >= 0.0 else -1.0
    y = abs(y)
    x1, y1 = p.corner_x[i, 0], p.corner_y[i, 0]
    x2, y2 = p.corner_x[i, 1], p.corner_y[i, 1]
    best_x, best_y = nearest(x, y, 0.0, 0.0, x1, y1)
    best = (x - best_x) ** 2 + (y - best_y) ** 2
    for edge in range(2):
        if edge == 0:
            px, py = nearest(x, y, x1, y1, x2, y2)
        else:
            px, py = nearest(x, y, x2, y2, p.length[i], 0.0)
        far = (x - px) ** 2 + (y - py) ** 2
        if far < best:
            best, best_x, best_y = far, px, py
    inside = (
        x * y1 > y * x1
        and (p.length[i] - x) * y2 > y * (p.length[i] - x2)
        and (y - y1) * (x2 - x1) < (x - x1) * (y2 - y1)
    )
    distance = -np.sqrt(best) if inside else np.sqrt(best)
    return best_x, side * best_y, distance


@compiled
def contact(p, s, w, h):
    """Contact forces of the present pose; True where anything touches."""
    touching = False
    w.depth = 0.0
    radius = p.cylinder[2]
    if radius <= 0.0:
        return False
    x, y, vx, vy = 0.0, 0.0, 0.0, 0.0
    stiff = h * p.contact_stiffness + p.contact_damping
    give = 1.0
    if p.ball_mass > 0.0:
        give = 1.0 / (1.0 + h * stiff / p.ball_mass)
    firm = stiff * give
    for i in range(HINGES):
        w.touch[i, :] = 0.0
        c, sn = w.cosine[i], w.sine[i]
        dx, dy = s.object[0] - x, s.object[1] - y
        reach = radius + p.length[i] + p.corner_y[i, 0]
        if dx * dx + dy * dy < reach * reach:
            px, py, distance = nearest_on_unit(p, i, c * dx + sn * dy, c * dy - sn * dx)
            rx, ry = c * px - sn * py, sn * px + c * py
            nx, ny = dx - rx, dy - ry
            size = np.sqrt(nx * nx + ny * ny)
            if size > 1e-12:
                scale = (1.0 if distance > 0.0 else -1.0) / size
                nx, ny = nx * scale, ny * scale
                point_vx, point_vy = vx - ry * s.rate[i], vy + rx * s.rate[i]
                depth = radius - distance
                slip_x, slip_y = point_vx - s.object[2], point_vy - s.object[3]
                closing = nx * slip_x + ny * slip_y
                push = give * (p.contact_stiffness * depth + stiff * closing)
                w.depth = max(w.depth, depth)
                if push > 0.0 and depth + h * closing > 0.0:
                    touching = True
                    slide = nx * slip_y - ny * slip_x
                    drag = p.cylinder[3] * push / np.sqrt(slide**2 + p.creep_speed**2)
                    w.touch[i, 0], w.touch[i, 1] = rx, ry
                    w.touch[i, 2] = -push * nx + drag * slide * ny
                    w.touch[i, 3] = -push * ny - drag * slide * nx
                    w.touch[i, 4] = h * (firm * nx * nx + drag * ny * ny)
                    w.touch[i, 5] = h * (firm - drag) * nx * ny
                    w.touch[i, 6] = h * (firm * ny * ny + drag * nx * nx)
                    w.touch[i, 7], w.touch[i, 8] = point_vx, point_vy
        x += p.length[i] * c
        y += p.length[i] * sn
        vx -= p.length[i] * sn * s.rate[i]
        vy += p.length[i] * c * s.rate[i]
    return touching


@compiled
def add_contact(w):
    """Add the contacts to the system matrix and to the generalised force."""
    fx, fy, xx, xy, yy = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(HINGES):
        i = HINGES - 1 - k
        tx, ty = w.v[i, 0], w.v[i, 1]
        ax, ay = -w.touch[i, 1], w.touch[i, 0]
        own_xx, own_xy, own_yy = w.touch[i, 4], w.touch[i, 5], w.touch[i, 6]
        w.force[i] += tx * fx + ty * fy + ax * w.touch[i, 2] + ay * w.touch[i, 3]
        beyond_x, beyond_y = xx * tx + xy * ty, xy * tx + yy * ty
        own_x, own_y = own_xx * ax + own_xy * ay, own_xy * ax + own_yy * ay
        w.u[i, 0] += beyond_x + own_x
        w.u[i, 1] += beyond_y + own_y
        w.diagonal[i] += tx * beyond_x + ty * beyond_y + ax * own_x + ay * own_y
        fx += w.touch[i, 2]
        fy += w.touch[i, 3]
        xx += own_xx
        xy += own_xy
        yy += own_yy


@compiled
def ride(p, s, time):
    """Where a peg is at a time, and how fast."""
    if p.orbit[0] > 0.0:
        angle = p.orbit[2] + p.orbit[1] * time
        c, sn = np.cos(angle), np.sin(angle)
        s.object[0] = p.cylinder[0] + p.orbit[0] * c
        s.object[1] = p.cylinder[1] + p.orbit[0] * sn
        s.object[2], s.object[3] = -p.orbit[0] * p.orbit[1] * sn, p.orbit[0] * p.orbit[1] * c


@compiled
def move_object(p, s, w, h):
    """Carry the object to the end of the step; rates are new, `pose` and time still old."""
    ride(p, s, s.time + h)
    if p.ball_mass <= 0.0:
        return
    fx, fy, vx, vy = 0.0, 0.0, 0.0, 0.0
    for i in range(HINGES):
        touch = w.touch[i]
        dx = vx - touch[1] * s.rate[i] - touch[7]
        dy = vy + touch[0] * s.rate[i] - touch[8]
        if touch[4] + touch[6] > 0.0:
            fx -= touch[2] - (touch[4] * dx + touch[5] * dy) / h
            fy -= touch[3] - (touch[5] * dx + touch[6] * dy) / h
        vx -= p.length[i] * w.sine[i] * s.rate[i]
        vy += p.length[i] * w.cosine[i] * s.rate[i]
    s.object[2] += h * fx / p.ball_mass
    s.object[3] += h * fy / p.ball_mass
    s.object[0] += h * s.object[2]
    s.object[1] += h * s.object[3]


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
