"""Steps of an axis forward in time, as they are pasted behind the generated `torque` and compiled.

    J·dv/dt = torque(q, v, ...) - b·v - k·q,    dq/dt = v

Steps are linearly implicit in the speed, v' = v + h·T/(J - h·∂T/∂v), because dry friction is stiff
at standstill.
"""
# ruff: noqa: F821
# mypy: ignore-errors

from collections.abc import Callable, Sequence

from spirob.effects import Effect
from spirob.machine.forward import torque as generated
from spirob.machine.kernel_loop import function, load

NUDGE = 1e-3  # of the rest speed, for the derivative by speed
FAR = 1e9  # a wrong model may run away; its error is large enough then


def loop_of(effects: Sequence[type[Effect]]) -> Callable[..., None]:
    """run(out, segments, steps, motion, given, control, own, p, start), compiled for these effects.

    out       (3, n): position, speed and effort; rows of no segment stay as they are
    segments  (s, 2): first row of each and the one behind its last;  steps (s,) their period [s]
    motion    (3, n): time, position, speed as measured; a segment begins there
    given     (n,): effort at each row, or position to follow where a controller runs
    control   (6,): 1 where it runs, position, velocity and integral gain, factor to SI, limit in SI
    own, p    as `torque` takes them;  start (m,) what the memory of each segment begins with
    """
    constants = f"NUDGE, FAR = {NUDGE!r}, {FAR!r}"
    parts = [generated.source(effects), constants]
    parts += [f"@njit(cache=True)\n{function(f, f.__name__)}" for f in (asked, total, run)]
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


def run(out, segments, steps, motion, given, control, own, p, start):
    """Every segment from its measured state; see `loop_of`."""
    memory, following, aside = start.copy(), start.copy(), start.copy()
    nudge, inertia = NUDGE * own[REST], own[INERTIA]
    for s in range(len(segments)):
        memory[:] = start
        first, last, h = segments[s, 0], segments[s, 1], steps[s]
        q, v, a, wound = motion[1, first], motion[2, first], 0.0, 0.0
        for k in range(first, last):
            effort = given[k]
            if control[0] > 0.0:
                effort, wound = asked(q, v, given[k], h, control, wound)
            out[0, k], out[1, k], out[2, k] = q, v, effort
            here = total(motion[0, k], q, v, a, effort, h, own, p, memory, following)
            beside = total(motion[0, k], q, v + nudge, a, effort, h, own, p, memory, aside)
            slope = min(0.0, (beside - here) / nudge)
            a = here / (inertia - h * slope)
            v += h * a
            q += h * v
            memory[:] = following
            if not abs(q) < FAR:
                out[0, k:last], out[1, k:last], out[2, k:last] = FAR, 0.0, 0.0
                break
