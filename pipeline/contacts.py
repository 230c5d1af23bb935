"""How well contacts are told: 200 simulated and 50 emulated ones, each with a free twin.

It takes minutes, and is not a stage.

    python -m pipeline.contacts

Thresholds are tuned in simulation (with the named effect) and tried on the robot as they are.
Writes reports/metrics/contacts.json.
"""

from pathlib import Path
from typing import Any

from joblib import Parallel, delayed

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
from pipeline.wraps import SENSOR_NOISE
from spirob.ending import end_with_parent
from spirob.errors import ConfigError
from spirob.experiments.contact_parts import in_parts
from spirob.experiments.contact_rates import (
    SIGNALS,
    Uncurling,
    outcomes,
    roc,
    scaled,
    tuned,
    uncurlings,
)
from spirob.experiments.side import Side

SIMULATED, EMULATED = 40, 10  # pegs for each of five motions
LOGS = Path("data/contacts/raw")


def stage(root: Path) -> None:
    """Play and judge."""
    config = public_config(root)
    if config.robot.kind == "can":
        raise ConfigError("contacts are played on an emulated or simulated robot, not on hardware")
    hidden = read_yaml(root / HIDDEN, "config") or {}
    named = read_json(root / "data/diagnosis/model.json", "decide")
    plain = config.model_dump()
    domains = {}
    for domain, pegs, seed in (("simulation", SIMULATED, 1), ("robot", EMULATED, 2)):
        trials = uncurlings(pegs, seed)
        jobs = [delayed(_play)(root, plain, hidden, named, domain, t) for t in trials]
        domains[domain] = (trials, Parallel(n_jobs=workers(), initializer=end_with_parent)(jobs))
        tell(f"{domain}: {len(trials)} uncurlings")
    write_json(root / "reports/metrics/contacts.json", judged(domains))


def judged(domains: dict[str, tuple[list[Uncurling], list[Side]]]) -> dict[str, Any]:
    """Rates by signal and domain, with the paper's thresholds and with tuned ones.

    Each are told together and by place, gap and motion; the ROC is that of one common factor.
    """
    out: dict[str, Any] = {}
    for signal in SIGNALS:
        scale = tuned(outcomes(*domains["simulation"], signal))
        out[signal] = {"tuned_scale": scale}
        for domain, played in domains.items():
            found = outcomes(*played, signal)
            out[signal][domain] = {
                "paper": in_parts(found, scaled(1.0)),
                "tuned": in_parts(found, scaled(scale)),
                "roc": roc(found),
            }
    return out


def _play(
    root: Path,
    plain: dict[str, Any],
    hidden: dict[str, Any],
    named: dict[str, Any],
    domain: str,
    trial: Uncurling,
) -> Side:
    config = Config.model_validate(plain)
    if domain == "robot":
        return robot_side(config, hidden, trial.play, root / LOGS / f"{trial.play.name}.mcap")
    return model_side(config, trial.play, named, SENSOR_NOISE, trial.number)


if __name__ == "__main__":
    entry("contacts", stage, __doc__)
