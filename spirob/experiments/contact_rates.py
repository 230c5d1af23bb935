"""How often, how soon and how wrongly contacts are declared, over many uncurlings.

Trials differ in the tendon's speed, the load of the other tendon (the baseline of the current), the
place of the peg and its gap.  Each has a twin with the peg out of reach and with the same noise,
since noise alone moves the slips of the tendon in time; a contact begins when their currents part.
What a detector says before, or of a twin, is a false alarm; what it says while the tendon is
pressed on by no more than a given travel is a hit, so travel stands for strength.

Rates are told apart by where the peg stands and by how the arm comes to it.  Place and gap are
drawn and are cut into equal parts, of contacts alone; speed and load, which set how hard the arm
presses, are those of the motions, whose free twins count as free motion.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from spirob.experiments import Play, Side
from spirob.experiments.active_contact import RIGHT, ActiveContact
from spirob.experiments.response import PERIOD, onset
from spirob.perceive.contact import ContactSettings, Levels, declared, levels

MOTIONS = ((0.035, 0.1), (0.035, 0.2), (0.05, 0.15), (0.06, 0.1), (0.06, 0.2))  # m/s, A
PLACES, GAPS = (0.45, 0.95), (0.004, 0.02)  # of the length; m
CURLED, UNCURLED = 0.15, 0.25  # m, travel of the tendon
SIGNALS = ("current", "filtered")
TRAVELS = (0.01, 0.02, 0.04)  # m, pressed on
EARLY = 0.02  # s; noise may part the currents a little late
SCALES = tuple(np.round(np.geomspace(0.05, 4.0, 25), 4).tolist())  # of all thresholds together


@dataclass(frozen=True)
class Uncurling:
    """One drawn trial.

    motion  which of `MOTIONS`;  place along the arm, None without a peg
    number  of the noise, shared by two twins
    """

    motion: int
    number: int
    place: float | None
    play: Play
    about: ActiveContact


@dataclass(frozen=True)
class Outcome:
    """What one trial offers to a detector on one signal.

    seen   levels from the start of its watch;  begins  onset after that [s], NaN without contact
    speed  of the tendon [m/s];  load  current of the other motor, which gives way [A]
    place  along the arm, None without a peg;  gap  between the straight arm and the peg [m]
    """

    seen: Levels
    begins: float
    speed: float
    load: float
    place: float | None
    gap: float


def uncurlings(pegs: int, seed: int) -> list[Uncurling]:
    """For every motion that many trials with a peg, drawn, each after its twin without."""
    rng = np.random.default_rng(seed)
    out = []
    for motion, (speed, low) in enumerate(MOTIONS):
        whole = ActiveContact(
            speed=speed, low=low, curl=CURLED / speed, uncurl=UNCURLED / speed, recoil=0.1
        )
        for k in range(pegs):
            place, gap = float(rng.uniform(*PLACES)), float(rng.uniform(*GAPS))
            about = replace(whole, places=(place,), gap=gap)
            number = motion * pegs + k
            for where, play in zip((None, place), about.plays()[:2], strict=True):
                # an emulated robot draws its noise by the trial's name
                plain = {**play.trial, "name": f"contact_{motion}_{k}"}
                name = f"{plain['name']}{'_free' if where is None else ''}"
                out.append(Uncurling(motion, number, where, Play(name, plain), about))
    return out


def outcomes(trials: Sequence[Uncurling], sides: Sequence[Side], signal: str) -> list[Outcome]:
    """What every trial offers on one signal; sides in the order of the trials."""
    free = {t.number: s for t, s in zip(trials, sides, strict=True) if t.place is None}
    out = []
    for trial, side in zip(trials, sides, strict=True):
        first, last = trial.about.window()
        seen = levels(side.driven(signal, RIGHT)[first:last], ContactSettings())
        begins = float("nan")
        if trial.place is not None:
            alone = free[trial.number].driven("current", RIGHT)[:last]
            begins = onset(side.driven("current", RIGHT)[:last], alone, first) - first * PERIOD
        about = trial.about
        out.append(Outcome(seen, begins, about.speed, about.low, trial.place, about.gap))
    return out


def rates(found: Iterable[Outcome], rules: ContactSettings) -> dict[str, Any]:
    """Rates of one detector on one signal.

    contacts  how many;  hits  travel [mm] -> share declared within it;  ever  share at all
    delay     median and 95th percentile from onset to decision [ms], of those declared
    alarms    false ones a minute of free motion [1/min];  minutes  of it
    """
    delays, travels, alarms, minutes, contacts = [], [], 0, 0.0, 0
    for one in found:
        sample = declared(one.seen, rules)
        when = float("inf") if sample is None else sample * PERIOD
        begins = one.begins if np.isfinite(one.begins) else len(one.seen.rise) * PERIOD
        minutes += min(begins, when) / 60
        alarms += when < begins - EARLY
        if np.isfinite(one.begins):
            contacts += 1
            told = np.isfinite(when) and when >= begins - EARLY
            delays += [1e3 * (when - begins)] if told else []
            travels.append((when - begins) * one.speed if told else float("inf"))
    pressed = np.array(travels)
    return {
        "contacts": contacts,
        "hits": {f"{1e3 * t:g}": _share(pressed <= t) for t in TRAVELS},
        "ever": _share(np.isfinite(pressed)),
        "delay": [float(q) for q in np.quantile(delays, [0.5, 0.95])] if delays else None,
        "alarms": alarms / minutes if minutes else 0.0,
        "minutes": minutes,
    }


def scaled(scale: float) -> ContactSettings:
    """The paper's thresholds, all times `scale`."""
    paper = ContactSettings()
    return replace(
        paper,  # type: ignore[type-var]
        absolute=scale * paper.absolute,
        relative=scale * paper.relative,
        slope=scale * paper.slope,
    )


def roc(found: Sequence[Outcome]) -> list[dict[str, float]]:
    """Share of contacts declared within 20 mm, and false alarms a minute, over `SCALES`."""
    told = [(s, rates(found, scaled(s))) for s in SCALES]
    return [{"scale": s, "hits": t["hits"]["20"], "alarms": t["alarms"]} for s, t in told]


def tuned(found: Sequence[Outcome]) -> float:
    """The least scale without a false alarm; the paper's own, 1, where none is."""
    calm = [point["scale"] for point in roc(found) if point["alarms"] == 0.0]
    return min(calm) if calm else 1.0


def _share(holds: np.ndarray) -> float:
    return float(np.mean(holds)) if len(holds) else 0.0


PARTS = 5


def in_parts(found: Sequence[Outcome], rules: ContactSettings) -> dict[str, Any]:
    """All rates of one detector on one signal, together and as by_place, by_gap and by_motion."""
    return {
        **rates(found, rules),
        "by_place": by_place(found, rules),
        "by_gap": by_gap(found, rules),
        "by_motion": by_motion(found, rules),
    }


def by_place(found: Sequence[Outcome], rules: ContactSettings) -> list[dict[str, Any]]:
    """Rates in five equal parts of the places; "place" is a part's middle, of the arm's length."""
    return _cut(found, rules, "place", PLACES, lambda one: one.place or 0.0)


def by_gap(found: Sequence[Outcome], rules: ContactSettings) -> list[dict[str, Any]]:
    """Rates in five equal parts of the gaps; "gap" is a part's middle [m]."""
    return _cut(found, rules, "gap", GAPS, lambda one: one.gap)


def by_motion(found: Sequence[Outcome], rules: ContactSettings) -> list[dict[str, Any]]:
    """Rates for each motion; "speed" [m/s] and "load" [A] are its own."""
    parts = []
    for speed, load in MOTIONS:
        there = [o for o in found if (o.speed, o.load) == (speed, load)]
        parts.append({"speed": speed, "load": load, **rates(there, rules)})
    return parts


def _cut(
    found: Sequence[Outcome],
    rules: ContactSettings,
    name: str,
    span: tuple[float, float],
    value: Callable[[Outcome], float],
) -> list[dict[str, Any]]:
    parts = []
    contacts = [o for o in found if o.place is not None]
    for low, high in pairwise(np.linspace(*span, PARTS + 1)):
        there = [o for o in contacts if low <= value(o) < high]
        middle = float(f"{(low + high) / 2:.6g}")
        parts.append({name: middle, **rates(there, rules)})
    return parts
