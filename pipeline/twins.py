"""What a fit can foretell of the active contact: twins of the robot whose numbers are as uncertain.

A twin is the emulated robot itself, with every number that is fitted moved by what the fit leaves
open of it (a draw from its covariance).  It shares all equations with the robot, which no model
does.  What twins get wrong, no model whose numbers come from these trials can be asked to get
right.  The named model is played with the same draws.

    python -m pipeline.twins

It looks into the robot, so it is no stage and nothing reads what it writes,
reports/metrics/twins.json.  It takes minutes.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from pipeline.diagnose import settings_of
from pipeline.model import plant, residual
from pipeline.schema import Config
from pipeline.sides import model_side, robot_side
from pipeline.stage import (
    HIDDEN,
    entry,
    public_config,
    read_json,
    read_yaml,
    tell,
    workers,
    write_json,
)
from spirob.effects import find_effects
from spirob.errors import ConfigError
from spirob.experiments import Play, experiment_from
from spirob.experiments.active_contact import RAW, RIGHT, ActiveContact
from spirob.experiments.response import AIM_RMSE, detected, rmse
from spirob.identify.descent import differences
from spirob.identify.intervals import block_covariance
from spirob.identify.scaling import Scaling
from spirob.perceive.contact import ContactSettings
from spirob.plant import Rig

DRAWS = 40
SEED = 0
LOGS = Path("data/twins/raw")
# fitted numbers of the model -> numbers of the emulated robot that mean the same
SAME = {
    "winch.efficiency": ["efficiency"],
    "motor.rotor_damping": ["rotor_damping"],
    "motor.rotor_inertia": ["rotor_inertia"],
    "arm.base_stiffness": ["stiffness", "damping"],  # damping is a time times stiffness
    "arm.damping_time": ["damping"],
    "tendon.stiffness": ["tendon_stiffness"],
    "capstan_friction.friction": ["guide_friction"],
    "capstan_friction.presliding": ["guide_slip_distance"],
}


def stage(root: Path) -> None:
    """Play the robot, its twins and the named model, and compare their recoils."""
    config = public_config(root)
    settings = config.paper.get("active_contact")
    if config.robot.kind != "emulated" or settings is None:
        raise ConfigError("twins are of an emulated robot, and of the experiment active_contact")
    contact = experiment_from("active_contact", settings, Rig.from_mapping(config.rig).geometry)
    assert isinstance(contact, ActiveContact)
    hidden = read_yaml(root / HIDDEN, "config") or {}
    named = read_json(root / "data/diagnosis/model.json", "decide")
    draws = drawn(root, config, named)
    tell(f"{len(draws)} draws of {', '.join(draws[0])}")
    plays = {p.name: p for p in contact.plays()}
    found = {}
    for place in contact.places:
        play = plays[f"uncurl_{100 * place:.0f}"]
        found[f"{place:.0%}"] = _compared(root, config, hidden, named, draws, contact, play)
        tell(f"contact at {place:.0%}: {found[f'{place:.0%}']}")
    write_json(root / "reports/metrics/twins.json", found)


def drawn(root: Path, config: Config, named: Mapping[str, Any]) -> list[dict[str, float]]:
    """Numbers of the named model as its fit might as well have ended."""
    model = plant(config, find_effects(named["effects"]))
    train = residual(root, config, model, "train")
    changes = named["changes"]
    scaling = Scaling(train.table, list(changes))
    u = scaling.scaled(changes)
    slopes = differences(train, scaling, u, {})
    scale = settings_of(config).scale
    covariance = block_covariance(slopes, train(changes), train.edges, scale, train.block)
    normal = np.random.default_rng(SEED).multivariate_normal(u, covariance, size=DRAWS)
    return [scaling.physical(np.clip(one, scaling.low, scaling.high)) for one in normal]


def factors(one: Mapping[str, float], named: Mapping[str, float]) -> dict[str, np.ndarray]:
    """What the robot's numbers are multiplied by, for left and right, where those differ; (2,)."""
    out: dict[str, np.ndarray] = {}
    for name, numbers in SAME.items():
        if name not in one:
            continue
        apart = [
            1.0 + np.array([1.0, -1.0]) * fitted.get(f"{name}_difference", 0.0)
            for fitted in (one, named)
        ]
        factor = one[name] / named[name] * apart[0] / apart[1]
        for number in numbers:
            out[number] = out.get(number, 1.0) * factor
    return out


def _compared(
    root: Path,
    config: Config,
    hidden: Mapping[str, Any],
    named: Mapping[str, Any],
    draws: list[dict[str, float]],
    contact: ActiveContact,
    play: Play,
) -> dict[str, Any]:
    """Recoils [s] after the uncurling began, and how many are within the aim of the robot."""

    def robot(k: int, moved: Mapping[str, np.ndarray] | None = None) -> np.ndarray:
        log = root / LOGS / f"{play.name}_{k}.mcap"
        return robot_side(config, hidden, play, log, moved).driven(RAW, RIGHT)

    def model(changes: Mapping[str, float]) -> np.ndarray:
        one = {"effects": named["effects"], "changes": {**named["changes"], **changes}}
        return model_side(config, play, one).driven(RAW, RIGHT)

    moved = [factors(one, named["changes"]) for one in draws]
    jobs = [delayed(robot)(0), *(delayed(robot)(k + 1, m) for k, m in enumerate(moved))]
    itself, *twins = Parallel(n_jobs=workers(), prefer="threads")(jobs)
    models = Parallel(n_jobs=workers(), prefer="threads")(delayed(model)(one) for one in draws)

    def recoil(current: np.ndarray) -> float | None:
        told = float(detected(current, *contact.window(), ContactSettings()))
        return round(told - contact.begins, 3) if np.isfinite(told) else None

    def told(currents: list[np.ndarray]) -> dict[str, Any]:
        errors = [rmse(one, itself) for one in currents]
        return {
            "recoils": sorted(t for one in currents if (t := recoil(one)) is not None),
            "within_aim": sum(e <= AIM_RMSE for e in errors),
            "mean_rmse": round(float(np.mean(errors)), 4),
        }

    return {
        "robot": recoil(itself),
        "draws": len(draws),
        "twins": told(twins),
        "model": told(models),
    }


if __name__ == "__main__":
    entry("twins", stage, __doc__)
