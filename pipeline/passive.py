"""Pushes felt by the current alone: how many, how soon, how wrongly, and where along the arm.

The current loop is on the host, without the back-EMF term (docs/experiments.md).  Regions are
learned from pushes of drawn places, strengths and sides in the named model, with the sensor's
noise, and told on the robot without retraining.

    python -m pipeline.passive

It is no stage: nothing reads what it writes, reports/metrics/passive.json.  It takes minutes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
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
from spirob.ending import end_with_parent
from spirob.experiments import Play, Side
from spirob.experiments.host_contact import HostContact
from spirob.experiments.host_loop import GainSet
from spirob.perceive.passive import PassiveDetector, Response
from spirob.perceive.passive_region import REGIONS, features, learned, region

SEED = 0
SIMULATED, PLAYED = 240, 80  # pushes
FREE, MINUTE = 30, 6.0  # trials without a push on the robot, and their length [s]
PLACES, COMPRESSIONS = (0.15, 0.97), (0.006, 0.014)  # of the length; m of the spring: 1.2-2.8 m/s
HIT = 0.9  # s
LATE = 0.4  # s after the hit within which it is felt, or missed
OUTER = 0.5  # of the length
LOGS = Path("data/passive/raw")
GAINS = GainSet(5.0, 0.0, 1e-3)


@dataclass(frozen=True)
class Push:
    """One drawn push; place None without any."""

    place: float | None
    play: Play


def pushes(count: int, rng: np.random.Generator, name: str) -> list[Push]:
    """Pushes of drawn places, strengths and sides."""
    out = []
    for k in range(count):
        place, compression = float(rng.uniform(*PLACES)), float(rng.uniform(*COMPRESSIONS))
        about = HostContact(compression=compression, hit=HIT, duration=HIT + 0.8)
        plain = about._trial(f"{name}_{k}", place)
        if rng.uniform() < 0.5:  # from the other side
            for key in ("y", "vy"):
                plain["scene"]["ball"][key] *= -1.0
        out.append(Push(place, Play(plain["name"], plain, GAINS.rig())))
    return out


def free(count: int) -> list[Push]:
    """Trials without a push."""
    about = HostContact(duration=MINUTE)
    names = [f"passive_free_{k}" for k in range(count)]
    return [Push(None, Play(n, about._trial(n, None), GAINS.rig())) for n in names]


def heard(side: Side) -> list[Response]:
    """Everything that the detector tells of a trial."""
    assert side.current is not None
    detector = PassiveDetector()
    told = [detector.update(i, x) for i, x in zip(side.current, side.displacement, strict=True)]
    return [one for one in told if one is not None]


def stage(root: Path) -> None:
    """Learn in the model, tell on the robot."""
    config = public_config(root)
    hidden = read_yaml(root / HIDDEN, "config") or {}
    named = read_json(root / "data/diagnosis/model.json", "decide")
    write_json(root / "reports/metrics/passive.json", measured(root, config, hidden, named))


def measured(
    root: Path, config: Config, hidden: dict[str, Any], named: Mapping[str, Any]
) -> dict[str, Any]:
    """Rates on the robot, and the share of regions told in model and robot."""
    rng = np.random.default_rng(SEED)
    simulated = pushes(SIMULATED, rng, "passive_model")
    played = [*pushes(PLAYED, rng, "passive_robot"), *free(FREE)]
    plain = config.model_dump()
    run = Parallel(n_jobs=workers(), initializer=end_with_parent)
    jobs = [delayed(_model)(plain, p.play, named, k) for k, p in enumerate(simulated)]
    in_model = run(jobs)
    tell(f"{len(jobs)} pushes in the model")
    in_robot = run([delayed(_robot)(root, plain, hidden, p.play) for p in played])
    tell(f"{len(played)} trials on the robot")
    train = [(r, p.place) for p, told in zip(simulated, in_model, strict=True) for r in of(told)]
    classifier = learned([r for r, _ in train], [p for _, p in train if p is not None])
    return {
        "model": rates(simulated, in_model, classifier),
        "robot": rates(played, in_robot, classifier),
        "learned_from": len(train),
    }


def of(told: Sequence[Response]) -> list[Response]:
    """The first response to the hit, where it was felt in time."""
    return [r for r in told if HIT <= 1e-3 * r.sample <= HIT + LATE][:1]


def rates(played: Sequence[Push], heard_of: Sequence[Sequence[Response]], told: Any) -> dict:
    """Shares felt, false alarms a minute, delays [ms], regions right of the pushes felt."""
    felt: dict[str, list[bool]] = {"all": [], "outer": [], **{r: [] for r in REGIONS}}
    delays, right, alarms, seconds = [], [], 0, 0.0
    for push, responses in zip(played, heard_of, strict=True):
        quiet = HIT if push.place is not None else push.play.trial["duration"]
        alarms += sum(1e-3 * r.sample < quiet for r in responses)
        seconds += quiet
        if push.place is None:
            continue
        found = of(responses)
        felt["all"].append(bool(found))
        felt[region(push.place)].append(bool(found))
        if push.place >= OUTER:
            felt["outer"].append(bool(found))
        for one in found:
            delays.append(1e3 * (1e-3 * one.sample - HIT))
            right.append((region(push.place), str(told.predict([features(one)])[0])))
    return {
        "pushes": len(felt["all"]),
        "felt": {k: float(np.mean(v)) for k, v in felt.items() if v},
        "false_alarms_per_minute": 60.0 * alarms / seconds,
        "minutes": seconds / 60.0,
        "delay_ms": [float(q) for q in np.quantile(delays, [0.5, 0.95])] if delays else None,
        "region_right": float(np.mean([a == b for a, b in right])) if right else None,
        "region_right_of": {
            r: float(np.mean([b == r for a, b in right if a == r]))
            for r in REGIONS
            if any(a == r for a, _ in right)
        },
    }


def _model(
    plain: dict[str, Any], play: Play, named: Mapping[str, Any], seed: int
) -> list[Response]:
    config = Config.model_validate(plain)
    noise = getattr(config.robot, "current_noise", 0.005)
    return heard(model_side(config, play, named, noise, seed))


def _robot(root: Path, plain: dict[str, Any], hidden: dict[str, Any], play: Play) -> list[Response]:
    config = Config.model_validate(plain)
    return heard(robot_side(config, hidden, play, root / LOGS / f"{play.name}.mcap"))


if __name__ == "__main__":
    entry("passive", stage, __doc__)
