"""Bodies as MuJoCo itself moves them, logged as a rig would log them."""

from collections.abc import Callable

import mujoco
import numpy as np

from spirob.effects import find_effects
from spirob.machine.description.rig import RigFile
from spirob.machine.forward import Forward, horizons
from spirob.machine.forward.axis import Axis, BodyTable, drive_reading
from spirob.machine.inverse.body import RigidBody
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from tests.machine.rigs import PENDULUM, description

RATE, FINE = 1e-3, 2e-4  # s, of the log and of MuJoCo's own steps
KNOWN = {"inertia": 0.0, "delay": 0.0}
PERIOD = 2 * np.pi * np.sqrt((0.003 + 0.4 * 0.15**2) / (0.4 * 9.81 * 0.15))  # s, of PENDULUM


def link(**joint: object) -> str:
    """PENDULUM with more attributes of its joint."""
    more = " ".join(f'{key}="{value}"' for key, value in joint.items())
    return PENDULUM.replace('name="shoulder"', f'name="shoulder" {more}')


def moved(
    text: str,
    start: list[float],
    seconds: float,
    effort: Callable[[float], list[float]] = lambda t: [0.0],
    tendon: bool = False,
) -> dict[str, np.ndarray]:
    """A log of MuJoCo's own motion (fourth order, 0.2 ms): t, q of the drive, others q1.., u."""
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep, model.opt.integrator = FINE, mujoco.mjtIntegrator.mjINT_RK4
    data = mujoco.MjData(model)
    data.qpos[:] = start
    rows = []
    for k in range(round(seconds / FINE)):
        wanted = np.array(effort(data.time))
        mujoco.mj_forward(model, data)
        if k % round(RATE / FINE) == 0:
            rows.append([data.time, data.ten_length[0] if tendon else data.qpos[0], wanted[0]])
            rows[-1] += list(data.qpos[1:])
        lever = data.ten_J.ravel()[0] if tendon else 1.0
        middle = np.array(effort(data.time + 0.5 * FINE))
        data.qfrc_applied[: len(wanted)] = middle * lever
        mujoco.mj_step(model, data)
    columns = np.array(rows).T
    return {"t": columns[0], "q": columns[1], "u": columns[2], **_others(columns[3:])}


def _others(columns: np.ndarray) -> dict[str, np.ndarray]:
    return {f"q{k + 1}": column for k, column in enumerate(columns)}


def problem(folder, text, log, effects=(), body=None, **changes):
    """The inverse problem of one log of a body."""
    (folder / "link.xml").write_text(text)
    given = {
        "known": KNOWN,
        "body": {"mjcf": "link.xml", "joint": "shoulder", **(body or {})},
        "fit": {"viscous": {"nominal": 0.0, "low": 0.0, "high": 1.0}},
        "filter": {"cutoff": 200.0, "drop": 50},
        "rows": {"standstill": "keep"},
        **changes,
    }
    rig = RigFile.model_validate(description(**given))
    made = RigidBody(rig.body, folder, rig.position.unit == "rad")
    sizes = Sizes(0.5, 2.0, 1.0, 2.0, 0.5, made.mass, "N·m", "N·m", "rad")
    log = {"u": np.zeros_like(log["t"])} | log
    if np.ptp(log["u"]) == 0.0:  # a log without effort would be refused; nobody feels this one
        log["u"] = 1e-12 * np.sin(log["t"])
    trial = prepare("log", log, rig)
    return InverseProblem(rig, made, [trial], find_effects(list(effects)), sizes, 1e-3)


def run(made, changes=None):
    """Time, and position and speed (measured, predicted) over the whole log."""
    changes = changes or {"rig.viscous": 0.0}
    assert Forward(made).absent(changes) == ""
    axis = Axis(made, BodyTable(made), changes)
    out = axis.run(horizons(made, np.inf), drive_reading(made.asked, axis.p))
    rows = ~np.isnan(out[0])
    motion = axis.motion
    return (
        motion.seconds[rows],
        (motion.q[rows], out[0][rows]),
        (motion.v[rows], out[1][rows]),
    )


def missed(made, changes):
    """RMS error of position, by horizon."""
    forward = Forward(made)
    found = forward.errors(changes, forward.predicted(changes))
    return {span: found[span]["position"]["rmse"] for span in ("window", "whole")}
