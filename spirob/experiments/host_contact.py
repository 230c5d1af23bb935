"""Single contact with the current loop on the host: voltages over the bus, readings a cycle old.

The same shots as in `single_contact`.  A motor that is pushed turns, and its back-EMF moves the
current until the loop has answered.  Fed forward as in (12), by a reading that is τ old, it is
taken away again all but k_e(ω(t) - ω(t - τ)); without that term feedback alone is against it.

How often a trial is played follows from its own standard error.  At each place two questions are
open: has the robot more than `SMALL` counts, and is the named model's peak off by more than
`APART`.  Shots are doubled, the robot's and the named model's, until the answer, "not asked",
"within" or "beyond", lies `SURE` standard errors from each border that it hangs on, or `most` are
played.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from spirob.errors import ConfigError
from spirob.experiments import BLOCK, Play, Side, Sides, curve, row
from spirob.experiments.host_loop import COMPARED, GainSet, OnHost, or_none
from spirob.experiments.passive import (
    BEYOND,
    COUNTS_PER_AMPERE,
    OPEN,
    SURE,
    WITHIN,
    Figure,
    compared,
    off,
    percent,
)
from spirob.experiments.response import smooth
from spirob.experiments.single_contact import (
    FIGURES,
    PEAK,
    READ,
    SMOOTHING,
    SingleContact,
    in_time,
    rank_agreement,
    responses,
    visible,
)

ORDER = 0.9  # least rank agreement
APART = 0.3  # most by which a peak of the model may be off
SMALL = 5.0  # counts; smaller peaks are not compared in size
NO_ORDER = "cannot be had"
NOT_ASKED = "not asked"
MODELS = ("base", "named", "single")
SENSITIVITIES = {
    "peak": "sensitivity along the arm",
    "arm peak": "reconstructed sensitivity along the arm",
}
Found = dict[str, list[dict[str, float]]]


def standard_error(side: Side, at: float, motor: int) -> float:
    """Of a mean's smoothed current within `PEAK` of a hit [counts], by how far its parts differ.

    at  of the hit [s]
    0 where there are no two parts.
    """
    if len(side.parts) < 2 or side.current is None:
        return 0.0
    soon = slice(round(1e3 * at), round(1e3 * (at + PEAK)))
    each = [smooth(part.driven("current", motor), SMOOTHING)[soon] for part in side.parts]
    return COUNTS_PER_AMPERE * float(np.sqrt(np.var(each, axis=0, ddof=1).mean() / len(each)))


def peak(told: Mapping[str, float]) -> Figure:
    """The peak of a response [counts]."""
    return Figure(told["peak"], told["peak noise"])


def judged(robot: Mapping[str, float], named: Mapping[str, float]) -> str:
    """What two peaks and their standard errors [counts] say of the size at a place."""
    least, sure = robot["peak"], SURE * robot["peak noise"]
    if least + sure < SMALL:
        return NOT_ASKED
    said = compared(peak(named), peak(robot), APART)
    return OPEN if said == BEYOND and least - sure <= SMALL else said


def played(side: Side) -> int:
    """Shots whose mean it is."""
    return BLOCK * len(side.parts)


def deviations(told: Mapping[str, Mapping[str, float]]) -> str:
    """The shots of the robot, and the standard error of each side's mean, where it has one."""
    noise = {s: r["peak noise"] for s, r in told.items() if r.get("peak noise")}
    each = ", ".join(f"{s} {value:.2g}" for s, value in noise.items())
    shots = f"{told['robot']['shots']:.0f} shots, " if "robot" in noise else ""
    return f"{shots}standard error in counts: {each}" if each else ""


def one_verdict(said: Collection[str]) -> bool | str | None:
    """Of all places: missed where one is beyond, met where none is left open."""
    if not said:
        return None
    if BEYOND in said or OPEN in said:
        return False if BEYOND in said else OPEN
    return True if WITHIN in said else NOT_ASKED


@dataclass(frozen=True, kw_only=True)
class HostContact(OnHost, SingleContact):
    """The shots of SingleContact under each set of gains."""

    title: ClassVar[str] = "Single contact, no gearbox, current loop on the host"
    about: ClassVar[str] = (
        "A loop in the drive answers a push within a fraction of a millisecond and hides it; one "
        "on the host hears of it a cycle late and answers slowly, so that the back-EMF of the "
        "pushed motor stands in its current. Whatever of that back-EMF the host feeds forward, "
        "as the paper's (12) does, it takes away again, but for what came within the latency. "
        "Single dynamics has no motor to be pushed: its current stays the commanded one, 0 counts "
        "at every place, which is 100 % off and has no order, while its angle answers."
    )
    named: ClassVar[str] = "host_ball"
    shots: int = 2 * BLOCK
    most: int = 96

    def __post_init__(self) -> None:
        for key in ("shots", "most"):
            count = getattr(self, key)
            if count < 2 * BLOCK or count % BLOCK:
                raise ConfigError(
                    f"paper.host_contact.{key} = {count}: blocks of {BLOCK} shots, two at least"
                )

    def play(self, name: str, place: float | None, one: GainSet) -> Play:
        return replace(super().play(name, place, one), shots=self.shots)

    def more(self, sides: Sides) -> list[Play]:
        return [play for one in self.sets for play in self._more(sides, one)]

    def _more(self, sides: Sides, one: GainSet) -> list[Play]:
        """As many shots again of what is open, and of the trial without a hit, which all share."""
        verdicts = self._verdicts(self._found(sides, one))
        wanted: dict[float | None, int] = {
            place: min(2 * played(self.at(sides, one, place)["robot"]), self.most)
            for place, verdict in verdicts.items()
            if verdict == OPEN
        }
        wanted[None] = max(wanted.values(), default=0)
        plays = []
        for place, count in wanted.items():
            first = played(self.at(sides, one, place)["robot"]) if count else 0
            if count > first:
                play = self.play(self.play_of(one, place), place, one)
                plays.append(replace(play, shots=count - first, first=first, only=COMPARED))
        return plays

    def _found(self, sides: Sides, one: GainSet) -> Found:
        """Side -> responses at every place."""
        free = self.at(sides, one, None)
        alone = {s: standard_error(side, self.hit, self.motor) for s, side in free.items()}
        found: Found = {s: [] for s in free}
        for place in self.places:
            for s, hit in self.at(sides, one, place).items():
                error = np.hypot(standard_error(hit, self.hit, self.motor), alone[s])
                told = responses(hit, free[s], self.hit)
                found[s].append(told | {"peak noise": float(error), "shots": played(hit)})
        return found

    def _verdicts(self, found: Found) -> dict[float, str]:
        """What each place says of the size, where robot and named model both have a current."""
        if not {"robot", "named"} <= set(found):
            return {}
        pairs = zip(self.places, found["robot"], found["named"], strict=True)
        return {place: judged(robot, named) for place, robot, named in pairs}

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        rows = [GainSet(b, 1.0, self.latency).margin() for b in self.bandwidths]
        rows += self.told_rows()
        for one in self.sets:
            found = self._found(sides, one)
            for key, what in READ:
                for k, place in enumerate(self.places):
                    told = {s: r[k] for s, r in found.items() if key in r[k]}
                    rows.append(self._row(f"{what}, {one.words}, at {place:.0%}", key, told))
            if "robot" in found:
                rows += [self._order(one, found), self._size(one, found)]
        return rows

    def _row(self, what: str, key: str, told: dict[str, dict[str, float]]) -> dict[str, Any]:
        """With how far noise may have moved a peak."""
        found = super()._row(what, key, told)
        noise = deviations(told) if key == "peak" else ""
        return found | {"note": "; ".join(n for n in (found["note"], noise) if n)}

    def _order(self, one: GainSet, found: Found) -> dict[str, Any]:
        """Rank of the current's peak; no aim can be had where the robot shows none at a place."""
        robot = found["robot"]
        peaks = {s: [r["peak"] for r in rows] for s, rows in found.items() if "peak" in rows[0]}
        agree = {m: rank_agreement(peaks[m], peaks["robot"]) for m in MODELS if m in peaks}
        agree["robot"] = rank_agreement(peaks["robot"], list(self.places))
        met: bool | str = bool(min(agree["robot"], agree.get("named", np.nan)) >= ORDER)
        note = "robot: against the distance from the base, models: against the robot"
        least = [max(r["peak error"], one.unsure) for r in robot]
        pairs = zip(self.places, robot, least, strict=True)
        hidden = [place for place, r, error in pairs if not visible(r["peak"], error)]
        if hidden:
            met = NO_ORDER
            at = ", ".join(f"{place:.0%}" for place in hidden)
            rpm = f"; half an rpm fed forward makes {one.unsure:.1f} counts" if one.share else ""
            note = f"{note}; {NO_ORDER}, for the robot's peak is not visible at {at}{rpm}"
        what, aim = f"rank agreement of current peak, {one.words}", f"at least {ORDER} each"
        paper = "rises to the tip"
        return row(what, "1", or_none(agree), paper=paper, aim=aim, met=met, note=note)

    def _size(self, one: GainSet, found: Found) -> dict[str, Any]:
        """How far the models' peaks are off where the robot's is larger than `SMALL`, at worst."""
        robot, verdicts = found["robot"], self._verdicts(found)
        told = [k for k, r in enumerate(robot) if r["peak"] > SMALL]
        off = {
            m: max(abs(found[m][k]["peak"] / robot[k]["peak"] - 1.0) for k in told)
            for m in MODELS
            if m in found and told
        }
        notes = [
            f"worst of the places where the robot shows more than {SMALL:g} counts: "
            + (", ".join(f"{self.places[k]:.0%}" for k in told) or "none")
        ]
        for verdict in (BEYOND, OPEN):
            places = [k for k, said in enumerate(verdicts.values()) if said == verdict]
            each = [self._place(k, robot[k], found["named"][k]) for k in places]
            notes += [f"{verdict}: {', '.join(each)}"] if each else []
        met = one_verdict(verdicts.values())
        what = f"current peak off the robot's, {one.words}"
        return row(what, "1", off, aim=f"at most {APART}", met=met, note="; ".join(notes))

    def _place(self, k: int, robot: Mapping[str, float], named: Mapping[str, float]) -> str:
        """A place with the robot's peak there and how far the model's is off."""
        size, share = peak(robot), off(peak(named), peak(robot))
        shown = f"{size.value:.2f} ± {size.error:.2f} counts in {robot['shots']:.0f} shots"
        return f"{self.places[k]:.0%} ({shown}, {percent(share)} off)"

    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        out, at = [], 100 * np.array(self.places)
        for one in self.sets:
            for s, found in self._found(sides, one).items():
                for key, quantity in FIGURES:
                    if key in found[0]:
                        peaks = np.array([r[key] for r in found])
                        out.append(curve(one.words, quantity, "counts", s, at, peaks, 1))
        slowest = self.slowest
        for s, found in self._found(sides, slowest).items():
            for key, quantity in SENSITIVITIES.items():
                if key in found[0]:  # of the ball's momentum
                    each = np.array([r[key] for r in found]) / (1e3 * self.mass * self.speed)
                    out.append(curve(slowest.words, quantity, "counts/(mN·s)", s, at, each, 1))
        for place in self.places[:: max(1, len(self.places) // 3)]:
            play = f"{slowest.words}, at {place:.0%}"
            hit, free = (self.at(sides, slowest, p) for p in (place, None))
            out += in_time(play, hit, free, self.hit, self.motor)
        return out
