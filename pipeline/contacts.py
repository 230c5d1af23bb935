"""How well contacts are told: 200 simulated and 50 emulated ones, each with a free twin.

It takes minutes, and is not a stage.

    python -m pipeline.contacts

Thresholds are tuned in simulation (with the named effect) and tried on the robot as they are.
Writes reports/metrics/contacts.json.
"""

from pathlib import Path
from typing import Any

from pipeline.sides import Stand
from pipeline.stage import entry, tell, write_json
from pipeline.wraps import SENSOR_NOISE
from spirob.errors import ConfigError
from spirob.experiments import Side
from spirob.experiments.contact_rates import (
    SIGNALS,
    Uncurling,
    in_parts,
    outcomes,
    roc,
    scaled,
    tuned,
    uncurlings,
)

SIMULATED, EMULATED = 40, 10  # pegs for each of five motions
LOGS = Path("data/contacts/raw")


def stage(root: Path) -> None:
    """Play and judge."""
    stand = Stand.of(root)
    if stand.config.robot.kind == "can":
        raise ConfigError("contacts are played on an emulated or simulated robot, not on hardware")
    simulated, emulated = uncurlings(SIMULATED, 1), uncurlings(EMULATED, 2)
    in_model = stand.each(stand.model, [(t.play, SENSOR_NOISE, t.number) for t in simulated])
    tell(f"simulation: {len(simulated)} uncurlings")
    on_robot = stand.each(stand.robot, [(t.play, LOGS) for t in emulated])
    tell(f"robot: {len(emulated)} uncurlings")
    domains = {"simulation": (simulated, in_model), "robot": (emulated, on_robot)}
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


if __name__ == "__main__":
    entry("contacts", stage, __doc__)
