"""Contact of the arm with one round object: a fixed cylinder, a peg on a circle, a ball.

The outline of a unit is a convex polygon: its two slanted faces and its outer edge, on each side
of the axis.  The point of it nearest to the cylinder's centre is the one contact point of that
unit, exact for a round object.  With depth δ = R - distance and n from the point to the centre

    N = k δ + c δ̇  ≥ 0          on the unit along -n
    F_t = -μ N v_t / √(v_t² + v_0²)     regularised Coulomb friction

Both enter the system matrix: the spring with its stiffness, friction with its secant, which is
dissipative and stable at any step.  v_0 = 1 mm/s is the creep that stands for sticking.

A peg goes round at constant speed.  A ball of mass m gives way within the step, which divides N
by 1 + h (h k + c)/m; what the arm feels of it at the end of the step then moves it.
"""

import numpy as np

from spirob.emulator.physics.compiled import HINGES, compiled

NUMBERS = {
    "cylinder": (4,),  # x, y, radius [m], friction [-]; radius 0: no object
    "orbit": (3,),  # of a peg round x, y: radius [m], speed [rad/s], phase [rad]; 0: no peg
    "ball_mass": (),  # [kg]; 0: no ball
    "corner_x": (HINGES, 2),
    "corner_y": (HINGES, 2),
    "contact_stiffness": (),  # [N/m]
    "contact_damping": (),  # [N·s/m]
    "creep_speed": (),  # v_0 [m/s]
}
STATE = {"object": (4,)}  # x, y [m], vx, vy [m/s]
SCRATCH = {
    "touch": (HINGES, 9),  # arm (2) [m], force (2) [N], stiffness xx, xy, yy [kg], rate (2) [m/s]
    "depth": (),  # deepest penetration [m]
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
