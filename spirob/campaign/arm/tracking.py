"""How well an emulated arm tracks a fast motion with the feed-forward of the model that was found.

`python -m spirob.campaign.arm.tracking DATA ...`: each folder is a pipeline's data of an emulated
robot that was diagnosed blind.  The left winch follows a motion that no log holds, by a controller
on the host; the right one holds its tendon taut.  Ahead of the controller goes the current of the
exported motor (`spirob.export.arm`) for this motion, under the tension that the model's arm
then pulls with:

    none    nothing
    fitted  the numbers that were fitted before any effect was added
    model   what the diagnosis takes home
    truth   the current that the robot itself needs, found under a stiff controller

Errors are RMS of the wound-in length, in metres; see `spirob.campaign.tracking.summary`.  `slack`
is the share of the time in which the left tendon of the robot pulls nothing while it plays the
truth: what follows is a jerk, which no current ahead of time can meet.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from spirob.campaign.tracking import STIFF, summary
from spirob.control import CURRENT, DISPLACEMENT, Gains, Schedule
from spirob.emulator.machine import Machine
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.export.arm import BASE, CorrectedArm, corrected_arm, lever_of, motor_of, reported_lever
from spirob.export.code import python_text
from spirob.export.corrected import read_document
from spirob.plant import Plant, Rig
from spirob.plant.session import CYCLE
from spirob.robot import MOTORS, Scene

SECONDS = 5.0
SETTLED = 0.5  # s, before errors count
MIDDLE = 0.03  # m, about which the winch moves
TONES = ((0.018, 0.4, 0.0), (0.006, 1.05, 1.0))  # m, Hz, rad: twice as fast as any log
TAUT = 0.6  # A, on the right
RISE = 0.8  # s, in which the motion begins
SLACK = 0.01  # N


def tracked(data: Path, faster: float = 1.0, taut: float = TAUT) -> dict[str, Any]:
    """RMS tracking errors of a diagnosed robot with each feed-forward.

    faster  than the usual motion, so many times;  taut  current on the right [A]
    """
    document = read_document(data / "diagnosis/diagnosis.json")
    model = corrected_arm(document, data / "diagnosis")
    base = json.loads((data / BASE).read_text(encoding="utf-8"))["parameters"]
    numbers = {name: told["value"] for name, told in base.items()}
    fitted = replace(model, effects=(), changes=numbers)
    robot, wanted = _robot(data, model.rig), _motion(faster)
    stiff = _played(robot, wanted, np.zeros(len(wanted)), STIFF, taut)
    ahead = {
        "none": np.zeros(len(wanted)),
        "fitted": _ahead(fitted, wanted, taut),
        "model": _ahead(model, wanted, taut),
        "truth": stiff.current,
    }
    kept = slice(round(SETTLED / CYCLE), None)
    errors = {}
    for name, current in ahead.items():
        missed = _played(robot, wanted, current, 1.0, taut).missed[kept]
        errors[name] = float(np.sqrt(np.mean(missed**2)))
    named = [e.name() for e in model.effects]
    found = {"data": str(data), "verdict": document["verdict"], "named": named, "errors": errors}
    return found | {"slack": float(np.mean(stiff.tension[kept] < SLACK))}


def _robot(data: Path, rig: Rig) -> Machine:
    """The robot that was diagnosed, as it was before its first trial."""
    told = yaml.safe_load((data / "config/hidden.yaml").read_text(encoding="utf-8"))
    config = yaml.safe_load((data / "config/config.yaml").read_text(encoding="utf-8"))
    made = EmulatedRig(
        gear_ratio=rig.winch.gear_ratio,
        winch_radius=rig.winch.radius,
        geometry=rig.geometry,
        gravity=(rig.arm.gravity_x, rig.arm.gravity_y),
        current_bandwidth=rig.drive.bandwidth,
        current_noise=config["robot"]["current_noise"],
    )
    hidden = HiddenSettings(told["effect"], float(told["strength"]), told["build"])
    return Machine(made, hidden, int(told["seed"]))


def _motion(faster: float) -> np.ndarray:
    """Wanted length, its rate and that one's, (T, 3): at rest, then tones about the middle."""
    t = np.arange(0.0, SECONDS, CYCLE)
    x = MIDDLE + sum(a * np.sin(2 * np.pi * f * faster * t + p) for a, f, p in TONES)
    u = np.clip(faster * t / RISE, 0.0, 1.0)
    x = x * u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
    rate = np.gradient(x, CYCLE)
    return np.column_stack([x, rate, np.gradient(rate, CYCLE)])


def _ahead(model: CorrectedArm, wanted: np.ndarray, taut: float) -> np.ndarray:
    """Current that the exported left motor asks for, (T,)."""
    own = model.rig.gains
    gains = Gains(**{n: getattr(own, n) for n in Gains.parameters()} | _stiff(own, STIFF))
    reference = np.column_stack([wanted[:, 0], np.full(len(wanted), taut)])
    rate = np.column_stack([wanted[:, 1], np.zeros(len(wanted))])
    modes, limits = np.array([DISPLACEMENT, CURRENT]), np.full(2, 10.0)
    plant = Plant(replace(model.rig, gains=gains), model.effects)
    played = plant.simulate(Schedule(modes, reference, rate, limits), Scene(), model.changes)
    axis, lever = motor_of(model, MOTORS[0]), lever_of(model, MOTORS[0])
    names: dict[str, Any] = {}
    exec(compile(python_text(axis), "exported", "exec"), names)  # of checked arithmetic alone
    state, asked = names["State"](), []
    for row, tension in zip((wanted / reported_lever(model)).tolist(), played.tension, strict=True):
        state.carried = lever * float(tension[0])
        asked.append(names["compensate"](state, *row, CYCLE))
    return np.array(asked)


def _stiff(gains: Gains, times: float) -> dict[str, float]:
    return {"velocity": gains.velocity * times, "displacement": gains.displacement * times}


@dataclass(frozen=True)
class Played:
    """Current of the left motor [A], how far its winch is off [m], its tension [N]; (T,) each."""

    current: np.ndarray
    missed: np.ndarray
    tension: np.ndarray


def _played(
    robot: Machine, wanted: np.ndarray, ahead: np.ndarray, times: float, taut: float
) -> Played:
    """Play a motion on the robot.

    times  by which both gains of the controller, proportional on rate and length, are stiffer
    """
    robot.start(Scene(), "tracking")
    gains, radius = _stiff(Gains(), times), robot.rig.winch_radius
    current, missed, tension = (np.zeros(len(wanted)) for _ in range(3))
    last = 0.0
    for k, (x, rate, _) in enumerate(wanted):
        turned = (robot.state["rotor_angle"][0] - robot.state["rotor_start"][0])[0]
        length = float(radius * turned / robot.rig.gear_ratio)
        speed, last = (length - last) / CYCLE, length
        missed[k] = x - length
        follow = rate + gains["displacement"] * missed[k] - speed
        current[k] = ahead[k] + gains["velocity"] * follow
        robot.cycle((float(np.clip(current[k], -10.0, 10.0)), taut))
        tension[k] = robot.state["tension"][0, 0]
    return Played(current, missed, tension)


def main(arguments: Sequence[str] | None = None) -> None:
    """Track on all robots and write what came out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path, nargs="+")
    parser.add_argument("--faster", type=float, default=1.0)
    parser.add_argument("--taut", type=float, default=TAUT, help="A")
    chosen, rows = parser.parse_args(arguments), []
    for data in chosen.data:
        rows.append(tracked(data, chosen.faster, chosen.taut))
        print(json.dumps(rows[-1]), flush=True)
    print(json.dumps(summary(rows), indent=2))


if __name__ == "__main__":
    main()
