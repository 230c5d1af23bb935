"""How well a fast motion is tracked with the feed-forward of the model that was found.

`python -m spirob.campaign.tracking --seeds 9000 9001 --json FILE`: rigid axes of the campaign with
something hidden are diagnosed blind and exported; then each plays a motion that it has not played
yet, under its own controller, with the feed-forward of four models in turn:

    none    the controller alone
    fitted  the numbers that were fitted, without any effect
    model   what the diagnosis takes home: with the named effects, or the fitted numbers alone
    truth   the torque that the axis itself needs for this motion, found under a stiff controller

What counts is the share of the gain, in RMS errors; see `summary`.
"""

import argparse
import json
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from spirob.campaign.case import Case, drawn, made_of, stream
from spirob.campaign.simulators import SIMULATORS
from spirob.campaign.simulators.hidden import Hidden
from spirob.campaign.simulators.motion import FINE, Machine, Plan, plan
from spirob.errors import SpirobError
from spirob.export.code import python_text
from spirob.export.corrected import Corrected, corrected
from spirob.machine.axis import diagnose_recordings
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import prepare
from spirob.machine.result import Diagnosis

KINDS = (
    "none", "coulomb_friction", "stribeck_friction", "presliding_friction",
    "load_dependent_friction", "direction_dependent_efficiency", "asymmetric_viscous_friction",
    "quadratic_drag", "cogging", "torque_ripple", "tip_payload", "constant_force",
    "torque_constant_saturation", "driver_dead_band",
)  # fmt: skip
SECONDS = 8.0
EVERY = 5  # samples of FINE between two of the feed-forward
STIFF = 10.0  # times the controller's frequency, where the truth is asked
SETTLED = 0.5  # s, before errors count
ENOUGH = 0.9  # of a gain
NOTHING = 1.05  # times the truth's error: fitted numbers that leave no more leave nothing to gain


def tracked(case: Case) -> dict[str, Any]:
    """RMS tracking errors of a case with each feed-forward; `refused` where there is no model."""
    made, told = made_of(case, stream(case)), drawn(case)
    machine = made.machine
    found: dict[str, Any] = {"kind": case.kind, "seed": case.seed, "rig": machine.rig}
    try:
        with tempfile.TemporaryDirectory() as folder:
            diagnosis = _diagnosed(told.rig, [*told.train, told.test], Path(folder))
            model = corrected(diagnosis.document, Path(folder))
    except SpirobError as error:
        return found | {"refused": str(error)}
    rng = np.random.default_rng([case.seed, 77])
    fast = plan("tones", rng, SECONDS, machine.stroke, machine.fastest)
    speed = np.gradient(fast.wanted, 1.0 / FINE)
    fitted = corrected(_bare(diagnosis), Path())
    ahead = {
        "none": np.zeros(len(fast.wanted)),
        "fitted": _torque(fitted, machine, fast, speed),
        "model": _torque(model, machine, fast, speed),
        "truth": _truth(machine, made.hidden, fast),
    }
    errors = {name: _error(machine, made.hidden, fast, torque) for name, torque in ahead.items()}
    return found | {
        "verdict": diagnosis.verdict,
        "named": [e.name for e in model.effects],
        "way": model.way,
        "must": told.truth["must"],
        "errors": errors,
    }


def _diagnosed(plain: dict[str, Any], logs: Sequence[Any], folder: Path) -> Diagnosis:
    rig = RigFile.model_validate(plain)
    read = [prepare(f"log_{k}", columns, rig) for k, columns in enumerate(logs)]
    return diagnose_recordings(rig, folder, read[:-1], read[-1:])


def _bare(diagnosis: Diagnosis) -> dict[str, Any]:
    """The same diagnosis with the numbers as they were fitted without any effect."""
    model = dict(diagnosis.document["model"])
    numbers = dict(model["numbers"])
    numbers |= {
        name: known["value"] for name, known in diagnosis.parameters.items() if "." not in name
    }
    return {**diagnosis.document, "model": {**model, "effects": [], "numbers": numbers}}


def _torque(model: Corrected, machine: Machine, fast: Plan, speed: np.ndarray) -> np.ndarray:
    """Torque that a model puts ahead of the controller, (n,)."""
    names: dict[str, Any] = {}
    exec(compile(python_text(model), "exported", "exec"), names)  # of checked arithmetic alone
    state, rows = names["State"](), slice(None, None, EVERY)
    acceleration = np.gradient(speed, 1.0 / FINE)
    motion = zip(fast.wanted[rows], speed[rows], acceleration[rows], strict=True)
    effort = [names["compensate"](state, *map(float, row), EVERY / FINE) for row in motion]
    torque = machine.constant * np.repeat(effort, EVERY)[: len(speed)]
    return np.asarray(torque - machine.numbers.back * speed)


def _truth(machine: Machine, hidden: Hidden, fast: Plan) -> np.ndarray:
    """Torque with which the axis plays the motion, under a controller that hardly lets it off."""
    p = machine.numbers
    stiff = p._replace(stiff=STIFF**2 * p.stiff, damped=STIFF * p.damped, hold=1)
    motion = SIMULATORS["rigid"].play(replace(machine, numbers=stiff), hidden, fast)
    return np.asarray(machine.constant * motion.effort - p.back * motion.v)


def _error(machine: Machine, hidden: Hidden, fast: Plan, ahead: np.ndarray) -> float:
    """RMS of what the axis is off, over the stroke."""
    motion = SIMULATORS["rigid"].play(machine, hidden, replace(fast, ahead=ahead))
    missed = (motion.q - fast.wanted)[round(SETTLED * FINE) :]
    return float(np.sqrt(np.mean(missed**2)) / machine.stroke)


def summary(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """What feed-forward gains where an effect was named, and how often anything was worsened.

    gain  (none - model)/(none - truth), of all that feed-forward can do
    own   (fitted - model)/(fitted - truth), of what the effects alone can add to fitted numbers
    one_way  gains with models whose export says that they are for motions of one way: this is none
    """
    played = [r for r in rows if "errors" in r]
    warned = [_share(r["errors"], "none") for r in played if r["way"]]
    both = [r for r in played if not r["way"]]
    named = [r["errors"] for r in both if r["verdict"] == "named"]
    others = [r["errors"] for r in both if r["verdict"] != "named"]
    gain = [_share(e, "none") for e in named]
    own = [_share(e, "fitted") for e in named if e["fitted"] > NOTHING * e["truth"]]
    return {
        "cases": len(rows),
        "refused": len(rows) - len(played),
        "named": len(named),
        "gain": _told(gain),
        "one_way": _told(warned),
        "own": _told(own),
        "not_named": len(others),
        "not_named_worse_than_none": sum(e["model"] > e["none"] for e in others),
        "named_worse_than_fitted": sum(e["model"] > e["fitted"] for e in named),
    }


def _share(errors: dict[str, float], before: str) -> float:
    return (errors[before] - errors["model"]) / (errors[before] - errors["truth"])


def _told(shares: Sequence[float]) -> dict[str, Any]:
    """How many, how many of 90 % at least, least, quartiles."""
    if not shares:
        return {"count": 0}
    least, low, middle, high = np.quantile(shares, (0.0, 0.25, 0.5, 0.75)).tolist()
    enough = int(np.sum(np.array(shares) >= ENOUGH))
    found: dict[str, Any] = {"count": len(shares), "at_least_0.9": enough}
    return found | {"least": least, "quartiles": [low, middle, high]}


def main(arguments: Sequence[str] | None = None) -> None:
    """Track all cases and write what came out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, nargs="+", default=[9000, 9001])
    parser.add_argument("--kinds", nargs="+", default=list(KINDS))
    parser.add_argument("--json", type=Path)
    chosen = parser.parse_args(arguments)
    rows = []
    for seed in chosen.seeds:
        for kind in chosen.kinds:
            rows.append(tracked(Case("rigid", kind, seed)))
            print(json.dumps(rows[-1], ensure_ascii=False), flush=True)
    found = summary(rows)
    print(json.dumps(found, indent=2))
    if chosen.json:
        chosen.json.write_text(json.dumps({"summary": found, "cases": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
