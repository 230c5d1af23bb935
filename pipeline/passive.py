"""Stage `passive`: pushes felt by the current alone, and where along the arm they were.

The current loop is on the host, without the back-EMF term (docs/experiments.md).  Regions are
learned from pushes of drawn places, strengths and sides in the named model, with the sensor's
noise and what a trial of the robot without a push tells of its loop, and told on the robot without
retraining.  Writes data/passive/regions.skops and
reports/metrics/passive.json: how many were felt, how soon, how wrongly, and where.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from sklearn.pipeline import Pipeline

from pipeline.sides import Stand, informed
from pipeline.stage import entry, tell, write_json
from spirob.experiments import Known, Play, Side
from spirob.experiments.host_contact import HostContact
from spirob.experiments.host_loop import GainSet
from spirob.perceive.model_file import save_model
from spirob.perceive.passive import REGIONS, PassiveDetector, Response, features, learned, region

PLACES, COMPRESSIONS = (0.15, 0.97), (0.006, 0.014)  # of the length; m of the spring: 1.2-2.8 m/s
HIT = 0.9  # s
LATE = 0.4  # s after the hit within which it is felt, or missed
FREE = 6.0  # s of a trial without a push
OUTER = 0.5  # of the length
LOGS = Path("data/passive/raw")
GAINS = GainSet(5.0, 0.0, 1e-3)


@dataclass(frozen=True)
class Push:
    """One drawn push; place None without any."""

    place: float | None
    play: Play


def stage(root: Path) -> None:
    """Learn in the model, tell on the robot; hardware is not driven."""
    stand = Stand.of(root)
    asked, noise = stand.config.passive, getattr(stand.config.robot, "current_noise", 0.0)
    rng = np.random.default_rng(asked.seed)
    stand, loop = _known(stand)
    simulated = pushes(asked.in_model, rng, "push_model")
    played = [*pushes(asked.on_robot, rng, "push_robot"), *free(asked.free)]
    given = [(replace(push.play, known=loop), noise, k) for k, push in enumerate(simulated)]
    in_model = [heard(side) for side in stand.each(stand.model, given)]
    tell(f"{len(simulated)} pushes in the model")
    train = [(of(told), p.place) for p, told in zip(simulated, in_model, strict=True)]
    known = [(found[0], place) for found, place in train if found and place is not None]
    classifier = learned([response for response, _ in known], [place for _, place in known])
    save_model(classifier, root / "data/passive/regions.skops")
    out = {"learned_from": len(known), "model": rates(simulated, in_model, classifier)}
    if stand.config.robot.kind != "can":
        on_robot = [heard(s) for s in stand.each(stand.robot, [(p.play, LOGS) for p in played])]
        tell(f"{len(played)} trials on the robot")
        out["robot"] = rates(played, on_robot, classifier)
    write_json(root / "reports/metrics/passive.json", out)


def _known(stand: Stand) -> tuple[Stand, Known]:
    """What a trial without a push tells of the robot, for its model; nothing of hardware."""
    given = {"named": stand.named}
    logs, about = stand.root / LOGS, HostContact()
    found, models = informed(stand.config, stand.hidden, about, given, logs)
    assert isinstance(found, HostContact)
    known = GAINS.known(found.told, found.motor) if found.told else Known()
    return replace(stand, named=models["named"]), known


def pushes(count: int, rng: np.random.Generator, name: str) -> list[Push]:
    """Pushes of drawn places, strengths and sides."""
    out = []
    for k in range(count):
        place, compression = float(rng.uniform(*PLACES)), float(rng.uniform(*COMPRESSIONS))
        about = HostContact(compression=compression, hit=HIT, duration=HIT + 0.8)
        plain = about.trial_at(f"{name}_{k}", place)
        if rng.uniform() < 0.5:  # from the other side
            for key in ("y", "vy"):
                plain["scene"]["ball"][key] *= -1.0
        out.append(Push(place, Play(plain["name"], plain, GAINS.rig())))
    return out


def free(count: int) -> list[Push]:
    """Trials without a push."""
    about = HostContact(duration=FREE)
    names = [f"push_free_{k}" for k in range(count)]
    return [Push(None, Play(n, about.trial_at(n, None), GAINS.rig())) for n in names]


def heard(side: Side) -> list[Response]:
    """Everything that the detector tells of a trial."""
    assert side.current is not None
    detector = PassiveDetector()
    told = [detector.update(i, x) for i, x in zip(side.current, side.displacement, strict=True)]
    return [one for one in told if one is not None]


def of(told: Sequence[Response]) -> list[Response]:
    """The first response to the hit, where it was felt in time."""
    return [r for r in told if HIT <= 1e-3 * r.sample <= HIT + LATE][:1]


def rates(
    played: Sequence[Push], heard_of: Sequence[Sequence[Response]], classifier: Pipeline
) -> dict[str, Any]:
    """Shares felt, false alarms a minute, delays [ms], share of regions right of the pushes felt.

    regions  counts, a row for each true region and a column for each that is told
    """
    felt: dict[str, list[bool]] = {"all": [], "outer": [], **{r: [] for r in REGIONS}}
    where: list[tuple[str, str]] = []
    delays: list[float] = []
    alarms, seconds = 0, 0.0
    for push, responses in zip(played, heard_of, strict=True):
        quiet = HIT if push.place is not None else push.play.trial["duration"]
        alarms += sum(1e-3 * r.sample < quiet for r in responses)
        seconds += quiet
        if push.place is None:
            continue
        found = of(responses)
        for group in ["all", region(push.place), *["outer"] * (push.place >= OUTER)]:
            felt[group].append(bool(found))
        for one in found:
            where.append((region(push.place), str(classifier.predict([features(one)])[0])))
            delays.append(one.sample - 1e3 * HIT)
    right = [true == told for true, told in where]
    return {
        "pushes": len(felt["all"]),
        "felt": {k: float(np.mean(v)) for k, v in felt.items() if v},
        "false_alarms_per_minute": 60.0 * alarms / seconds,
        "minutes": seconds / 60.0,
        "delay_ms": np.quantile(delays, [0.5, 0.95]).tolist() if delays else None,
        "region_right": float(np.mean(right)) if right else None,
        "regions": [[where.count((true, told)) for told in REGIONS] for true in REGIONS],
    }


if __name__ == "__main__":
    entry("passive", stage, __doc__)
