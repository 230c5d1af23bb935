"""Contact of the arm with a fixed cylinder.

The outline of a unit is a convex polygon: its two slanted faces and its outer edge, on each side
of the axis.  The point of it nearest to the cylinder's centre is the one contact point of that
unit, exact for a round object.  With depth δ = R - distance and n from the point to the centre

    N = k δ + c δ̇  ≥ 0          on the unit along -n
    F_t = -μ N v_t / √(v_t² + v_0²)     regularised Coulomb friction

Both enter the system matrix: the spring with its stiffness, friction with its secant, which is
dissipative and stable at any step.  v_0 = 1 mm/s is the creep that stands for sticking.
"""

import numpy as np

from spirob.emulator.physics.compiled import HINGES, compiled

NUMBERS = {
    "cylinder": (4,),  # x, y, radius [m], friction [-]; radius 0: no cylinder
    "corner_x": (HINGES, 2),
    "corner_y": (HINGES, 2),
    "contact_stiffness": (),  # [N/m]
    "contact_damping": (),  # [N·s/m]
    "creep_speed": (),  # v_0 [m/s]
}
STATE: dict[str, tuple[int, ...]] = {}
SCRATCH = {
    "touch": (HINGES, 7),  # arm (2) [m], force (2) [N], stiffness xx, xy, yy [kg]
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
    for i in range(HINGES):
        w.touch[i, :] = 0.0
        c, sn = w.cosine[i], w.sine[i]
        dx, dy = p.cylinder[0] - x, p.cylinder[1] - y
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
                closing = nx * point_vx + ny * point_vy
                push = p.contact_stiffness * depth + stiff * closing
                w.depth = max(w.depth, depth)
                if push > 0.0 and depth + h * closing > 0.0:
                    touching = True
                    slide = nx * point_vy - ny * point_vx
                    drag = p.cylinder[3] * push / np.sqrt(slide**2 + p.creep_speed**2)
                    w.touch[i, 0], w.touch[i, 1] = rx, ry
                    w.touch[i, 2] = -push * nx + drag * slide * ny
                    w.touch[i, 3] = -push * ny - drag * slide * nx
                    w.touch[i, 4] = h * (stiff * nx * nx + drag * ny * ny)
                    w.touch[i, 5] = h * (stiff - drag) * nx * ny
                    w.touch[i, 6] = h * (stiff * ny * ny + drag * nx * nx)
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
