"""Steps of an axis forward in time, as they are pasted behind the generated `torque` and compiled.

    (J + M)·dv/dt = T(q, v, ...) = torque - b·v - k·q - g - d·v - c·v² - dry·sign(v),    dq/dt = v

    q½ = q + h·v/2,    z = h·∂T/∂v / J,    v' = v + h·φ(z)·T(q½, v, ...)/J,    q' = q½ + h·v'/2

with φ(z) = (e^z - 1)/z; J holds M at q½ here, and M, g, d, c, dry are the body's (`body_table`).
Where nothing depends on the speed that is position Verlet, which keeps energies; where the rest is
linear in the speed it is exact in it, however stiff, as dry friction at standstill is.  The error
falls with h² where forces are smooth in between.
Hochbruck, Ostermann, Acta Numerica 19 (2010), section 2.4
"""
# ruff: noqa: F821
# mypy: ignore-errors

import math
from collections.abc import Callable, Sequence

from spirob.effects import Effect
from spirob.effects.pasting import pasted
from spirob.generated import load
from spirob.machine.forward import torque as generated
from spirob.machine.kernel_loop import KIND

NUDGE = 1e-3  # of the rest speed, for the derivative by speed
FAR = 1e9  # a wrong model may run away; its error is large enough then
STEEP = 0.1  # growth of a torque with the speed within a step, above which it is no torque
LONGEST = 1e-3  # s, of a step: a slow log is divided, as friction changes within its samples


def loop_of(effects: Sequence[type[Effect]]) -> Callable[..., None]:
    """run(out, segments, steps, motion, given, control, own, p, start, table, grid), compiled.

    out       (3, n): position, speed and effort; rows of no segment stay as they are
    segments  (s, 3): where its piece begins, its first row, the one behind its last; in order
    steps     (s,): sample period [s]
    motion    (6, n): time, position, speed, acceleration, effort as measured, and the row of the
              body's table.  A segment begins there, with the memory that effects have of the
              measured motion of its piece before
    given     (n,): effort at each row, linear in between, or position to follow where a controller
              runs, which then holds its effort from row to row
    control   (8,): 1 where it runs, the five of `Control.gains`, factor to SI, limit in SI
    own, p    as `torque` takes them;  start (m,) what memory begins with
    table     (rows, nodes, AT) of the body, no nodes without one
    grid      (2,) first node and the distance to the next
    """
    constants = f"NUDGE, FAR, STEEP, LONGEST = {NUDGE!r}, {FAR!r}, {STEEP!r}, {LONGEST!r}"
    parts = [generated.source(effects), constants]
    parts += pasted((asked, beside, total, grown, step, follow, run))
    return load("\n\n".join(parts), KIND).run


def asked(q, v, goal, dt, control, wound):
    """Effort that a controller asks for, and the next integral of its error."""
    wound += dt * (control[4] * (goal - q) - control[5] * v)
    effort = control[6] * (control[1] * (goal - q) - control[2] * v + control[3] * wound)
    return min(max(effort, -control[7]), control[7]), wound


def beside(q, row, table, grid, at):
    """Let `at` hold what the table says at a position: cubic in that, linear between its rows."""
    nodes = table.shape[1]
    if nodes == 0:
        return
    x = min(max((q - grid[0]) / grid[1], 1.0), nodes - 2.0)
    i = min(int(x), nodes - 3)
    x -= i
    w = (
        0.5 * x * (x * (2.0 - x) - 1.0),  # Keys, IEEE Trans. ASSP 29 (1981), a = -1/2
        0.5 * (x * x * (3.0 * x - 5.0) + 2.0),
        0.5 * x * (x * (4.0 - 3.0 * x) + 1.0),
        0.5 * x * x * (x - 1.0),
    )
    r = min(int(row), table.shape[0] - 1)
    y, following = row - r, min(r + 1, table.shape[0] - 1)
    for c in range(table.shape[2]):
        at[c] = 0.0
        for n in range(4):
            here, there = table[r, i - 1 + n, c], table[following, i - 1 + n, c]
            at[c] += w[n] * (here + y * (there - here))


def total(time, q, v, a, effort, dt, own, at, p, memory, following):
    """Torque that accelerates the axis and its body."""
    body = at[STANDING] + (at[LINEAR] + at[SQUARE] * v) * v + at[DRY] * math.tanh(v / own[REST])
    load = (own[INERTIA] + at[MASS]) * a + own[STIFFNESS] * q + body
    out = torque(time, q, v, load, effort, dt, own, at, p, memory, following)
    return out - own[VISCOUS] * v - own[STIFFNESS] * q - body


def grown(z):
    """(e^z - 1)/z; 1 where z is large, as in laws that take an acceleration from their speeds."""
    return math.expm1(z) / z if z < STEEP and abs(z) > 1e-9 else 1.0


def step(time, q, v, a, effort, row, h, own, at, p, memory, following, aside, table, grid):
    """Position, speed and mean acceleration a step later."""
    middle, nudge = q + 0.5 * h * v, NUDGE * own[REST]
    beside(middle, row, table, grid, at)
    here = total(time, middle, v, a, effort, h, own, at, p, memory, following)
    faster = total(time, middle, v + nudge, a, effort, h, own, at, p, memory, aside)
    inertia = own[INERTIA] + at[MASS]
    a = here / inertia * grown(h * (faster - here) / (nudge * inertia))
    return middle + 0.5 * h * (v + h * a), v + h * a, a


def follow(begin, end, dt, parts, motion, own, at, p, memory, following, table, grid):
    """Let the effects remember the measured motion from one row to another."""
    for k in range(begin, end):
        for part in range(parts):
            x = (part + 0.5) / parts
            time, q, v, a, effort, row = (1.0 - x) * motion[:, k] + x * motion[:, k + 1]
            beside(q, row, table, grid, at)
            total(time, q, v, a, effort, dt / parts, own, at, p, memory, following)
            memory[:] = following


def run(out, segments, steps, motion, given, control, own, p, start, table, grid):
    """Every segment from its measured state; see `loop_of`."""
    past, memory, following, aside = start.copy(), start.copy(), start.copy(), start.copy()
    reached, at = -1, np.zeros(ACROSS + 1)
    for s in range(len(segments)):
        begin, first, last = segments[s]
        parts = max(1, math.ceil(steps[s] / LONGEST - 1e-6))
        h, wound = steps[s] / parts, 0.0
        if len(start) > 0:
            if reached < begin:
                past[:], reached = start, begin
            follow(
                reached, first, steps[s], parts, motion, own, at, p, past, following, table, grid
            )
            memory[:], reached = past, first
        q, v, a = motion[1, first], motion[2, first], motion[3, first]
        for k in range(first, last):
            after = min(k + 1, last - 1)
            effort, rise = given[k], given[after] - given[k]
            if control[0] > 0.0:
                effort, wound = asked(q, v, given[k], steps[s], control, wound)
                rise = 0.0
            out[0, k], out[1, k], out[2, k] = q, v, effort
            for part in range(parts):
                x = (part + 0.5) / parts
                now, push = motion[0, k] + x * steps[s], effort + x * rise
                row = (1.0 - x) * motion[5, k] + x * motion[5, after]
                q, v, a = step(
                    now, q, v, a, push, row, h, own, at, p, memory, following, aside, table, grid
                )
                memory[:] = following
            if not abs(q) < FAR:
                out[0, k:last], out[1, k:last], out[2, k:last] = FAR, 0.0, 0.0
                break
