"""Steps of an axis forward in time, as they are pasted behind the generated `torque` and compiled.

    J·dv/dt = T(q, v, ...) = torque(q, v, ...) - b·v - k·q,    dq/dt = v

    q½ = q + h·v/2,    z = h·∂T/∂v / J,    v' = v + h·φ(z)·T(q½, v, ...)/J,    q' = q½ + h·v'/2

with φ(z) = (e^z - 1)/z.  Where nothing depends on the speed that is position Verlet, which keeps
energies; where the rest is linear in the speed it is exact in it, however stiff, as dry friction at
standstill is.  The error falls with h² where forces are smooth in between.
Hochbruck, Ostermann, Acta Numerica 19 (2010), section 2.4
"""
# ruff: noqa: F821
# mypy: ignore-errors

import math
from collections.abc import Callable, Sequence

from spirob.effects import Effect
from spirob.machine.forward import torque as generated
from spirob.machine.kernel_loop import function, load

NUDGE = 1e-3  # of the rest speed, for the derivative by speed
FAR = 1e9  # a wrong model may run away; its error is large enough then
LONGEST = 1e-3  # s, of a step: a slow log is divided, as friction changes within its samples


def loop_of(effects: Sequence[type[Effect]]) -> Callable[..., None]:
    """run(out, segments, steps, motion, given, control, own, p, start), compiled for these effects.

    out       (3, n): position, speed and effort; rows of no segment stay as they are
    segments  (s, 3): where its piece begins, its first row, the one behind its last; in order
    steps     (s,): sample period [s]
    motion    (5, n): time, position, speed, acceleration, effort as measured.  A segment begins
              there, with the memory that effects have of the measured motion of its piece before
    given     (n,): effort at each row, linear in between, or position to follow where a controller
              runs, which then holds its effort from row to row
    control   (6,): 1 where it runs, position, velocity and integral gain, factor to SI, limit in SI
    own, p    as `torque` takes them;  start (m,) what memory begins with
    """
    constants = f"NUDGE, FAR, LONGEST = {NUDGE!r}, {FAR!r}, {LONGEST!r}"
    parts = [generated.source(effects), constants]
    pasted = (asked, total, grown, step, follow, run)
    parts += [f"@njit(cache=True)\n{function(f, f.__name__)}" for f in pasted]
    return load("\n\n".join(parts)).run


def asked(q, v, goal, dt, control, wound):
    """Effort that a cascade asks for, and the next integral of its speed error."""
    wrong = control[1] * (goal - q) - v
    wound += dt * wrong
    effort = control[4] * (control[2] * wrong + control[3] * wound)
    return min(max(effort, -control[5]), control[5]), wound


def total(time, q, v, a, effort, dt, own, p, memory, following):
    """Torque that accelerates the axis."""
    load = own[INERTIA] * a + own[STIFFNESS] * q
    out = torque(time, q, v, load, effort, dt, own, p, memory, following)
    return out - own[VISCOUS] * v - own[STIFFNESS] * q


def grown(z):
    """(e^z - 1)/z for z ≤ 0; what grows with the speed is taken as it is."""
    return math.expm1(z) / z if z < -1e-9 else 1.0


def step(time, q, v, a, effort, h, own, p, memory, following, aside):
    """Position, speed and mean acceleration a step later."""
    middle, nudge = q + 0.5 * h * v, NUDGE * own[REST]
    here = total(time, middle, v, a, effort, h, own, p, memory, following)
    beside = total(time, middle, v + nudge, a, effort, h, own, p, memory, aside)
    inertia = own[INERTIA]
    a = here / inertia * grown(h * (beside - here) / (nudge * inertia))
    return middle + 0.5 * h * (v + h * a), v + h * a, a


def follow(begin, end, dt, parts, motion, own, p, memory, following):
    """Let the effects remember the measured motion from one row to another."""
    for k in range(begin, end):
        for part in range(parts):
            x = (part + 0.5) / parts
            time, q, v, a, effort = (1.0 - x) * motion[:, k] + x * motion[:, k + 1]
            total(time, q, v, a, effort, dt / parts, own, p, memory, following)
            memory[:] = following


def run(out, segments, steps, motion, given, control, own, p, start):
    """Every segment from its measured state; see `loop_of`."""
    past, memory, following, aside = start.copy(), start.copy(), start.copy(), start.copy()
    reached = -1
    for s in range(len(segments)):
        begin, first, last = segments[s]
        parts = max(1, math.ceil(steps[s] / LONGEST - 1e-6))
        h, wound = steps[s] / parts, 0.0
        if len(start) > 0:
            if reached < begin:
                past[:], reached = start, begin
            follow(reached, first, steps[s], parts, motion, own, p, past, following)
            memory[:], reached = past, first
        q, v, a = motion[1, first], motion[2, first], motion[3, first]
        for k in range(first, last):
            effort, rise = given[k], given[min(k + 1, last - 1)] - given[k]
            if control[0] > 0.0:
                effort, wound = asked(q, v, given[k], steps[s], control, wound)
                rise = 0.0
            out[0, k], out[1, k], out[2, k] = q, v, effort
            for part in range(parts):
                along = (part + 0.5) / parts
                now, push = motion[0, k] + along * steps[s], effort + along * rise
                q, v, a = step(now, q, v, a, push, h, own, p, memory, following, aside)
                memory[:] = following
            if not abs(q) < FAR:
                out[0, k:last], out[1, k:last], out[2, k:last] = FAR, 0.0, 0.0
                break
