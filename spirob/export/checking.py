"""Proof of an export: the held-out logs are played in it, in a process that cannot import us."""

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from spirob.control.law import CURRENT
from spirob.errors import ExportError
from spirob.export.arm import CorrectedArm
from spirob.export.axis import equations
from spirob.export.body import AXIS
from spirob.export.code import c_name
from spirob.export.corrected import Corrected
from spirob.export.heldout import Errors, Heldout

PLAYERS = Path(__file__).parent / "players"
ALONE = (
    "import runpy, sys; sys.modules['spirob'] = sys.modules['pipeline'] = None; "
    "sys.argv = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"
)
LONGEST = 3600  # s
LOSS = 0.01  # of the effects' size, which an export may lose in silence


def played(model: Corrected, player: str, folder: Path, heldout: Heldout | None = None) -> Errors:
    """The errors of a model that was exported to a folder, on the held-out logs.

    Raises ExportError where it cannot be played, with what the player says.
    """
    heldout = heldout or Heldout(model)
    about = about_of(model, player)
    script = PLAYERS / f"{'mujoco' if player == 'mjcf' else player}.py"
    with tempfile.TemporaryDirectory() as place:
        given, result = Path(place) / "given.npz", Path(place) / "result.npz"
        np.savez(given, about=json.dumps(about), **heldout.given())  # type: ignore[arg-type]
        alone(script, folder.resolve(), given, result)
        with np.load(result) as made:
            return heldout.errors(made["effort"], made["framed"])


def about_of(model: Corrected, player: str) -> dict[str, Any]:
    """What a player is told beside the rows."""
    return {
        "name": c_name(model.name),
        "fields": list(equations(model).state),
        "joint": model.body.joint if model.body else AXIS,
        "others": list(model.body.others) if model.body else [],
        "controller": player == "mujoco",
    }


def played_arm(model: CorrectedArm, folder: Path) -> Errors:
    """The errors of an arm that was exported to a folder, on the trials kept aside.

    Compared are the currents of motors that are not themselves commanded a current.
    """
    plant, trials = model.plant(), model.trials()
    neutral = {f"{e.name()}.{f}": v for e in model.effects for f, v in e.neutral.items()}
    given: dict[str, np.ndarray] = {}
    for k, t in enumerate(trials):
        said = t.schedule
        given |= {f"mode_{k}": said.mode, f"limit_{k}": said.current_limit}
        given |= {f"reference_{k}": said.reference, f"rate_{k}": said.reference_rate}
        given[f"angle_{k}"] = np.array(t.first_angle)
    about = {"name": c_name(model.name), "trials": len(trials)}
    with tempfile.TemporaryDirectory() as place:
        kept, result = Path(place) / "given.npz", Path(place) / "result.npz"
        np.savez(kept, about=json.dumps(about), **given)  # type: ignore[arg-type]
        alone(PLAYERS / "arm.py", folder.resolve(), kept, result)
        with np.load(result) as made:
            played = [made[f"current_{k}"] for k in range(len(trials))]
    rows: list[list[np.ndarray]] = [[], [], [], []]
    for trial, exported in zip(trials, played, strict=True):
        ours, bare = (
            plant.simulate(trial.schedule, trial.scene, changes, trial.first_angle).current
            for changes in (model.changes, {**model.changes, **neutral})
        )
        driven = trial.schedule.mode != CURRENT
        for kind, values in zip(rows, (trial.current, ours, bare, exported), strict=True):
            kind.append(values[:, driven].ravel())
    measured, ours, bare, exported = (np.concatenate(kind) for kind in rows)

    def rms(values: np.ndarray) -> float:
        return float(np.sqrt(np.mean(values**2)))

    size = rms(ours - bare) if model.effects else rms(measured)
    return Errors(rms(ours - measured), rms(exported - measured), rms(exported - ours), size)


def alone(script: Path, *arguments: Path) -> None:
    """Run a script that cannot import this project; raises ExportError with what it says."""
    command = [sys.executable, "-I", "-c", ALONE, str(script), *map(str, arguments)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        raise ExportError(f"the exported model did not end within {LONGEST} s") from None
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["nothing"])[-1]
        raise ExportError(f"the exported model cannot be played: {said[:200]}")


def sentence(errors: Errors, unit: str) -> str:
    """Both errors side by side."""
    return (
        f"held-out error {errors.exported:.4g} {unit} exported, {errors.ours:.4g} {unit} here; "
        f"apart {errors.apart:.3g} {unit}, {percent(errors)}"
    )


def percent(errors: Errors) -> str:
    """What is lost, in words."""
    return f"{100 * errors.lost:.2g} % of the effects' size ({errors.size:.3g})"


def warning(errors: Errors) -> str:
    """The first line of an export that loses more than a per cent; empty for others."""
    if errors.lost <= LOSS:
        return ""
    return f"LOSES {percent(errors)} against the diagnosis, measured on its held-out logs"
