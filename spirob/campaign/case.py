"""One case of the campaign: a machine with something hidden, its logs, and what is right.

What is drawn follows from simulator, kind and seed alone.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from spirob.campaign.recorder import (
    RATES,
    Recorder,
    columns,
    description,
    drawn_recorder,
    even,
    length_of,
    reported,
    share,
)
from spirob.campaign.scoring import (
    BESIDE,
    DRAWN,
    KINDS,
    LIBRARY,
    NO_PARTNER,
    NONE,
    OUTSIDE,
    answers,
)
from spirob.campaign.simulators import SIMULATORS
from spirob.campaign.simulators.hidden import Hidden, Hiding, Scale, hiding
from spirob.campaign.simulators.motion import Machine, Motion, Plan, Simulator, plan

FASTEST = (0.3, 2.0)  # Hz, of the motion
SLOW_LOG = 40.0  # samples in a period of the fastest motion at least
QUICK = (4.0, 8.0)  # Hz, of machines whose time in the log is hidden
PROMPT = 500.0  # Hz, of their logs at least
SLOW = 0.05  # of the usual speed: what is slower goes no way
DRAWS = 200  # of partners, until they go together
LOW, HIGH = 0.12, 0.40  # of the effort: what is drawn
NEAR = (0.9, 1.1)  # of the wanted share: near enough
SEEN = 0.1  # of the effort: what a diagnosis can be asked for
TRIES = 6
LESS = (0.2, 0.6)  # of what the library's effect shows: what the one beside it shows
REST = (0.05, 0.3)  # of the effort: what nobody's law tells of it, as published logs have it


@dataclass(frozen=True)
class Case:
    """What is hidden, in which machine.

    kind     of the library or not, two or three by +, or "none"; "two", "three", "beside" are drawn
    without  the right effects, and what says a part of them, are no candidates
    disturbed  a force that wanders and no law tells is in the effort, up to a third of it
    """

    simulator: str
    kind: str
    seed: int
    without: bool = False
    disturbed: bool = False

    @property
    def name(self) -> str:
        """By which its result is found again."""
        further = "-without" * self.without + "-disturbed" * self.disturbed
        return f"{self.simulator}-{self.kind}-{self.seed}{further}"

    def kinds(self) -> tuple[str, ...]:
        """What is hidden."""
        if self.kind == NONE:
            return ()
        if self.kind not in DRAWN:
            return tuple(self.kind.split("+"))
        rng = np.random.default_rng([self.seed, 1, *f"{self.simulator}/{self.kind}".encode()])
        played = SIMULATORS[self.simulator].kinds
        able = sorted(played & set(LIBRARY) - NO_PARTNER)
        for _ in range(DRAWS):
            chosen = list(map(str, rng.choice(able, DRAWN[self.kind], replace=False)))
            if self.kind == BESIDE:
                chosen += [str(rng.choice(sorted(played & set(OUTSIDE))))]
            if together(chosen):
                break
        return tuple(chosen if self.kind == BESIDE else sorted(chosen))


@dataclass(frozen=True)
class Drawn:
    """A machine's logs and their description, as the diagnosis gets them; and the truth.

    truth  plain data: groups of names of which one each must be named, names that may stand
           besides, names that say a part, whether the logs can show it, share of each kind
    bare   logs of the same machine, plans and noise with nothing hidden, the last held out
    machine, hidden, played  what was drawn, and its motions before anything is read
    """

    rig: dict[str, Any]
    files: dict[str, str]
    train: list[dict[str, np.ndarray]]
    test: dict[str, np.ndarray]
    truth: dict[str, Any]
    about: dict[str, Any]
    bare: list[dict[str, np.ndarray]]
    machine: Machine
    hidden: Hidden
    played: list[Motion]


def together(kinds: Sequence[str]) -> bool:
    """Whether an axis can have all of these at once."""
    families = [KINDS[kind].family for kind in kinds]
    return len(set(families)) == len(families)


@dataclass(frozen=True)
class Made:
    """What a case is about: the machine, what is hidden in it, what it plays and how it is logged.

    nothing  its motions with nothing hidden, and their scale;  shares  of each kind
    """

    machine: Machine
    hidden: Hidden
    recorder: Recorder
    plans: list[Plan]
    nothing: list[Motion]
    scale: Scale
    shares: dict[str, float]


def made_of(case: Case, rng: np.random.Generator) -> Made:
    """Draw the machine of a case."""
    simulator, kinds = SIMULATORS[case.simulator], case.kinds()
    machine, recorder, plans, motions = _set_up(simulator, frozenset(kinds), rng)
    if case.disturbed:
        own = np.random.default_rng([case.seed, 2, *f"{case.simulator}/{case.kind}".encode()])
        recorder = replace(recorder, slow=even(own, REST))
    scale = _scale(machine, recorder, motions)
    found: dict[str, float] = {}
    shares: dict[str, float] = {}
    for kind in kinds:
        made = hiding(kind, scale, rng)
        wanted = float(np.exp(rng.uniform(np.log(LOW), np.log(HIGH))))
        if shares and kind in OUTSIDE:
            wanted = float(rng.uniform(*LESS)) * sum(shares.values())
        fields, shares[kind] = _adjusted(simulator, machine, recorder, plans, made, wanted)
        found |= fields
    return Made(machine, Hidden(**found), recorder, plans, motions, scale, shares)


def stream(case: Case) -> np.random.Generator:
    """The chance that draws a case."""
    return np.random.default_rng([case.seed, *f"{case.simulator}/{case.kind}".encode()])


def drawn(case: Case) -> Drawn:
    """Draw, play and record a case."""
    rng = stream(case)
    simulator, kinds = SIMULATORS[case.simulator], case.kinds()
    made = made_of(case, rng)
    machine, recorder, plans = made.machine, made.recorder, made.plans
    hidden, scale, shares = made.hidden, made.scale, made.shares
    motions = [simulator.play(machine, hidden, p) for p in plans]
    played = [reported(m, machine, hidden) for m in motions]
    speeds = np.concatenate([m.v[np.abs(m.v) > SLOW * scale.speed] for m in motions])
    one_way = bool(np.all(speeds > 0) or np.all(speeds < 0))
    truth = _truth(kinds, simulator, one_way, shares) | {"share": share(played, recorder.rate)}
    delay_known = any(KINDS[kind].family == "late" for kind in kinds)
    rig = description(machine, recorder, delay_known, rng)
    logs = [columns(m, machine, recorder, rng) for m in played]
    about = asdict(recorder) | {
        "rig": machine.rig,
        "effort": machine.effort,
        "origin": machine.origin,
        "warming": plans[0].warming,
        "one_way": one_way,
        "described": "body" in rig,
    }
    bare = _bare(made.nothing, played, machine, recorder, rng) if kinds else logs
    return Drawn(
        rig, machine.files, logs[:-1], logs[-1], truth, about, bare, machine, hidden, motions
    )


def _bare(
    motions: Sequence[Motion],
    played: Sequence[Motion],
    machine: Machine,
    recorder: Recorder,
    rng: np.random.Generator,
) -> list[dict[str, np.ndarray]]:
    """Logs of motions with nothing hidden, as noisy as those with what is hidden were."""
    sizes = [float(np.sqrt(np.mean(m.effort**2))) for m in played]
    told = [reported(m, machine, Hidden()) for m in motions]
    return [columns(m, machine, recorder, rng, size) for m, size in zip(told, sizes, strict=True)]


def _set_up(
    simulator: Simulator, kinds: frozenset[str], rng: np.random.Generator
) -> tuple[Machine, Recorder, list[Plan], list[Motion]]:
    """A machine, how it is logged, what it plays, and what it does with nothing hidden in it."""
    late = any(KINDS[kind].family == "late" for kind in kinds)
    rate = float(rng.choice([r for r in RATES if r >= PROMPT or not late]))
    low, high = QUICK if late else FASTEST
    fastest = min(float(rng.uniform(low, high)), rate / SLOW_LOG)
    machine = simulator.draw(rng, kinds, fastest)
    seconds = length_of(rate, rng)
    recorder = drawn_recorder(rng, machine, rate, seconds, 2.5 * fastest * machine.stroke)
    warming = float(rng.choice([0.0, 0.0, 0.0, rng.uniform(-0.05, 0.05)]))
    motions = [str(rng.choice(machine.motions))] * recorder.logs
    if rng.uniform() < 0.3 and "one way" not in motions:
        motions = [str(rng.choice(machine.motions)) for _ in motions]
    plans = [
        plan(motion, rng, seconds, machine.stroke, machine.fastest, warming) for motion in motions
    ]
    return machine, recorder, plans, [simulator.play(machine, Hidden(), p) for p in plans]


def _scale(machine: Machine, recorder: Recorder, motions: Sequence[Motion]) -> Scale:
    q, v, effort = (np.concatenate([getattr(m, n) for m in motions]) for n in ("q", "v", "effort"))
    return Scale(
        machine.constant * float(np.sqrt(np.mean(effort**2))),
        float(np.sqrt(np.mean(v**2))),
        float(0.5 * (q.max() + q.min())),
        float(0.5 * np.ptp(q)),
        recorder.seconds,
        machine.angular,
        machine.turn,
    )


def _adjusted(
    simulator: Simulator,
    machine: Machine,
    recorder: Recorder,
    plans: Sequence[Plan],
    made: Hiding,
    wanted: float,
) -> tuple[dict[str, float], float]:
    """The numbers of a kind that is alone in the machine, and the share that it shows."""

    def shown(at: float) -> float:
        hidden = Hidden(**made.at(at))
        played = [simulator.play(machine, hidden, p) for p in plans]
        return share([reported(m, machine, hidden) for m in played], recorder.rate)

    if made.fixed:
        return made.at(1.0), shown(1.0)
    at, found = strength(shown, wanted, made.most)
    return made.at(at), found


def strength(shown: Callable[[float], float], wanted: float, most: float) -> tuple[float, float]:
    """The strength at which a kind shows as much as is wanted, as nearly as can be; and the share.

    Where no strength shows it, it is moderate: what cannot be seen is no reason for a monster.

    shown  share at a strength
    """
    tried: list[tuple[float, float]] = []
    at = min(2.0 * wanted, most)
    for _ in range(TRIES):
        tried.append((at, shown(at)))
        ratio = wanted / max(tried[-1][1], 1e-6)
        if 1 / NEAR[1] < ratio < 1 / NEAR[0]:
            break
        at = min(max(_next(tried, wanted), 1e-3), most)
        if any(abs(at - before) < 1e-3 * at for before, _ in tried):
            break
    if max(found for _, found in tried) < SEEN:
        return tried[0]
    return min(tried, key=lambda one: abs(np.log(max(one[1], 1e-6) / wanted)))


def _next(tried: Sequence[tuple[float, float]], wanted: float) -> float:
    """Between the nearest below and above where there are both, else further in proportion."""
    below = [one for one in tried if one[1] < wanted]
    above = [one for one in tried if one[1] >= wanted]
    if below and above:
        (a, low), (b, high) = max(below, key=lambda o: o[1]), min(above, key=lambda o: o[1])
        part = np.log(wanted / max(low, 1e-6)) / np.log(high / max(low, 1e-6))
        return float(np.exp(np.log(a) + min(max(part, 0.15), 0.85) * np.log(b / a)))
    at, shown = tried[-1]
    return float(at * min(max(wanted / max(shown, 1e-6), 0.1), 6.0))


def _truth(
    kinds: Sequence[str], simulator: Simulator, one_way: bool, shares: dict[str, float]
) -> dict[str, Any]:
    keys = [answers(kind, simulator.bristles, one_way) for kind in kinds]
    asked = [kind for kind in kinds if KINDS[kind].names] or kinds
    return {
        "hidden": list(kinds),
        "inside": any(key.names for key in keys),
        "beside": 0 < sum(bool(key.names) for key in keys) < len(keys),
        "must": [sorted(key.names) for key in keys if key.names],
        "besides": sorted({name for key in keys for name in key.besides}),
        "near": sorted({name for key in keys for name in key.near}),
        "can_be_shown": all(shares[kind] >= SEEN for kind in asked),
        "shares": shares,
    }


def cases(
    simulators: Sequence[str],
    kinds: Sequence[str],
    seeds: Sequence[int],
    nulls: int = 0,
    without: bool = False,
    disturbed: bool = False,
) -> list[Case]:
    """Each kind that a simulator plays with every seed, and `nulls` machines with nothing hidden.

    kinds    empty: all, nothing hidden, and those that are drawn
    without  each single kind of the library again, with the right effects no candidates
    disturbed  all of them are
    """
    asked = list(kinds) or [NONE, *LIBRARY, *OUTSIDE, *DRAWN]
    first = min(seeds, default=0)
    found = [Case(s, k, n) for n in seeds for s in simulators for k in asked if able(s, k)]
    again = [c for c in found if c.kind in LIBRARY] if without else []
    found += [Case(c.simulator, c.kind, c.seed, True) for c in again]
    found += [Case(s, NONE, first + n) for n in range(nulls) for s in simulators]
    return [replace(case, disturbed=disturbed) for case in dict.fromkeys(found)]


def able(simulator: str, kind: str) -> bool:
    """Whether a simulator plays a kind."""
    parts = () if kind in (NONE, *DRAWN) else kind.split("+")
    return set(parts) <= SIMULATORS[simulator].kinds
