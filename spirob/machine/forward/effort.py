"""The effort that acted while a log was taken, from what the log says of it."""

from dataclasses import replace

import numpy as np

from spirob.machine.asked import AskedEffort
from spirob.machine.motion import late

PASSES = 10  # of the solution for the effort before its report
SETTLE = 0.5  # s in which a report comes to what it shows at the first row


def drive_reading(asked: AskedEffort, p: np.ndarray) -> np.ndarray:
    """The effort that the drive's own sensor saw at every row of the motion, (n,).

    Undone are the log's delay and what the model holds at `sensing.frame` and `sensing.report`;
    errors of the sensor itself are undone in the loop, as a controller meets them too.  Of a lag
    slow changes are restored: a fast one is noise by the time that it is reported.
    """
    measured = wanted = asked.motion.effort
    for effect in asked.present("sensing.frame", p):
        wanted = wanted - measured + asked.in_cycles(effect, p, asked.motion)
    delay = float(p[asked.table.position("rig.delay")])
    wanted = late(wanted, -delay, asked.motion)
    found = wanted
    if asked.present("sensing.report", p):
        for _ in range(PASSES):
            found = found + wanted - reported(asked, p, found)
    return found


def logged(asked: AskedEffort, p: np.ndarray, effort: np.ndarray) -> np.ndarray:
    """What the log would say of an effort that the drive's sensor sees, (n,)."""
    delay = float(p[asked.table.position("rig.delay")])
    return late(reported(asked, p, effort), delay, asked.motion)


def reported(asked: AskedEffort, p: np.ndarray, effort: np.ndarray) -> np.ndarray:
    """The effort as the drive reports it, (n,); before each piece it stood at its first value."""
    motion = asked.motion
    rows, starts = [], [0]
    for k, step in enumerate(motion.steps):
        own = np.arange(motion.starts[k], motion.starts[k + 1])
        rows.append(np.concatenate([np.full(round(SETTLE / step), own[0]), own]))
        starts.append(starts[-1] + len(rows[-1]))
    index = np.concatenate(rows)
    longer = replace(motion, starts=np.array(starts), q=motion.q[index])
    seen = {name: x[index] for name, x in asked.signals(motion, np.zeros_like(effort)).items()}
    found = effort[index]
    for effect in asked.present("sensing.report", p):
        found = asked.run(effect, p, longer, seen | {"motor.current": found}, found)
    long = np.diff(motion.starts)
    kept = [found[b - n : b] for n, b in zip(long, starts[1:], strict=True)]
    return np.concatenate(kept)
