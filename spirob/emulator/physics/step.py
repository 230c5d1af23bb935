"""One step of the machine, one bus cycle made of such steps, and the records that they work on.

Linearly implicit Euler: forces are taken at the end of the step, linearised in the new rates,

    H Δφ̇ = h f*,   H = M + h D + h² K

where f* is the force that the present rates would lead to.  Hinges, stops, contacts, the
stickiness of friction, gears and tendons are all in H or solved beside it, so no part needs an
artificial inertia; only the velocity terms of the chain and the direction of contact are explicit.

Each file of physics declares its own fields; here they become three numpy record types, numbers,
state and working room, so that compiled code reads `p.rotor_inertia[m]` and Python reads the same
memory by the same name.
"""

import hashlib
from pathlib import Path

import numpy as np

from spirob.emulator import physics
from spirob.emulator.physics import HINGES, SIDES, compiled, compiled_entry
from spirob.emulator.physics.arm import (
    creep,
    factorise,
    factorise_whole,
    hinges,
    inertia,
    pose,
    solve,
    solve_whole,
    weight_and_spin,
)
from spirob.emulator.physics.contact import (
    EVERY,
    add_contact,
    add_turns,
    contact,
    look_round,
    move_object,
)
from spirob.emulator.physics.drive import drive, feedback, understood
from spirob.emulator.physics.motor import motors, turn_winches
from spirob.emulator.physics.tendon import add_tendons, grow, guide_friction, routing, rub, tighten

FASTEST = 1e5  # rad/s of units and rotors together; beyond it the state is lost
PARTS = (physics.arm, physics.contact, physics.tendon, physics.drive, physics.motor)


@compiled
def add_hinges(w):
    """Hinge moments and their slopes, from hinge angles to absolute angles."""
    for i in range(HINGES):
        next_moment, next_implicit = 0.0, 0.0
        if i + 1 < HINGES:
            next_moment, next_implicit = w.moment[i + 1], w.implicit[i + 1]
        w.force[i] += w.moment[i] - next_moment
        w.diagonal[i] += w.implicit[i] + next_implicit
        w.sub[i] = -w.implicit[i]


@compiled
def answer(w, b, whole):
    """Overwrite b with H⁻¹b."""
    if whole:
        solve_whole(w, b)
    else:
        solve(w, b)


@compiled
def step(p, s, w, h):
    """Advance the machine by h; False where the state is lost.  `pose` must be up to date."""
    inertia(p, w)
    weight_and_spin(p, s, w)
    hinges(p, s, w, h)
    routing(p, s, w, h)
    guide_friction(p, s, w, h)
    add_tendons(w, h)
    add_hinges(w)
    if contact(p, s, w, h):
        add_contact(w)
    whole = add_turns(p, s, w, h)
    if not (factorise_whole(w) if whole else factorise(w)):
        return False
    for i in range(HINGES):
        w.force[i] *= h
    answer(w, w.force, whole)
    for i in range(HINGES):
        w.force[i] += s.rate[i]
    for m in range(SIDES):
        for i in range(HINGES):
            w.answer[m, i] = w.pull[m, i]
        answer(w, w.answer[m], whole)
    drive(p, s, w, h)
    motors(p, s, w, h)
    tighten(p, s, w, h)
    turn_winches(p, s, w, h)
    fastest = 0.0
    for i in range(HINGES):
        pulled = s.tension[0] * w.answer[0, i] + s.tension[1] * w.answer[1, i]
        s.rate[i] = w.force[i] + h * pulled
        s.phi[i] += h * s.rate[i]
        fastest = max(fastest, abs(s.rate[i]))
    move_object(p, s, w, h)
    pose(s, w)
    rub(p, s, w, h)
    creep(p, s, w, h)
    grow(p, s, h)
    s.time += h
    return fastest + abs(s.rotor_speed[0]) + abs(s.rotor_speed[1]) < FASTEST


@compiled_entry
def run_cycle(numbers, state, scratch, currents, noise, counts, steps, h):
    """Hold the commanded currents [A] for `steps` steps of h [s], then write the feedback.

    A machine in voltage mode takes the voltages that come in the cycle instead (`drive`).

    numbers, state, scratch  arrays of one record each
    noise    (2,) one standard normal number for each current sensor
    counts   (2, 4) int64, angle, speed, current and temperature of each drive
    steps    0 only measures: tendon shortening and contact depth of the present pose
    Returns True while the state is finite; the counts are not touched otherwise.
    """
    p, s, w = numbers[0], state[0], scratch[0]
    for m in range(SIDES):
        w.target[m] = understood(p, currents[m], m)
    pose(s, w)
    if steps == 0:
        routing(p, s, w, h)
        contact(p, s, w, h)
    often = max(int(EVERY / h), 1)
    w.taken = 0.0
    for k in range(steps):
        w.elapsed = k * h
        if k % often == 0:
            look_round(p, s, w)
        if not step(p, s, w, h):
            return False
    total = 0.0
    for i in range(HINGES):
        total += s.phi[i] + s.rate[i]
    for m in range(SIDES):
        total += s.rotor_angle[m] + s.current[m] + s.tension[m]
    if not np.isfinite(total):
        return False
    if steps > 0:
        feedback(p, s, noise, steps * h, counts)
    return True


def fingerprint() -> str:
    """Hash of the physics sources.

    Numba's disk cache looks at the file of the cached function only, so a change in a file that
    it imports would go unnoticed.  The hash is the name of a field of the record of numbers,
    thus a part of the entry point's signature, and a change anywhere compiles anew.
    """
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def _record(kind: str, extra: list[tuple[str, str, tuple[int, ...]]]) -> np.dtype:
    fields = [(name, "f8", shape) for part in PARTS for name, shape in getattr(part, kind).items()]
    return np.dtype(fields + extra, align=True)


NUMBERS = _record("NUMBERS", [(f"source_{fingerprint()}", "u1", ())])
STATE = _record("STATE", [])
SCRATCH = _record("SCRATCH", [])
