"""The library's numbers, meant for a small rotor, brought to the size and unit of another machine.

A kernel is homogeneous in its dimensions: with speeds in m/s and its amplitude in N it gives the
force that it would give in N·m for a rotor in rad/s.  So only nominal values and bounds have to be
moved, each by the ratio of the two machines' sizes in the dimension of its unit: a tenth of the
small rotor's torque becomes a tenth of the rig's effort.
"""

import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.effects import Effect
from spirob.errors import ConfigError
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.body import RigidBody
from spirob.machine.inverse.shapes import counts_periods, reads_a_disc
from spirob.machine.laws import shares_inertia
from spirob.machine.recordings.filtering import BELOW
from spirob.machine.recordings.recording import Recording
from spirob.parameter import Parameter

REFERENCE = {  # the small rotor for which the library's nominal numbers and bounds are given
    "torque": 0.02,  # N·m
    "speed": 50.0,  # rad/s
    "angle": 1.0,  # rad
    "force": 10.0,  # N, at its winch
    "length": 0.1,  # m, of its stroke
    "current": 1.0,  # A
    "mass": 0.1,  # kg
}
PERIODS = 2.0  # in the way travelled, for a wave to be known as one
PLAY = 0.005  # of the stroke: less of it cannot be told from the counts of an encoder
BRISTLE = 0.05  # of the stroke: what takes longer to turn round is a spring
OFF_CENTRE = 0.1  # of its radius, that an encoder's disc is off at most
WIDER = 0.8  # of the order of a disc's turn: where its fit may go
HEAT = {"current": -2, "time": -1}  # dimension of what warms by the square of an effort
HOTTEST = 9.0  # by the end of a trial: a tenth of the torque is left, and no machine moves on
FASTEST = 0.1  # of a trial: what warms within less follows the effort, as full iron does
SUPERSCRIPT = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
TOKEN = re.compile(r"([A-Za-zΩµ]+)([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]*)")
RAISED = {2: "²", 3: "³"}


@dataclass(frozen=True)
class Sizes:
    """How large a rig is, and what its quantities are measured in.

    torque    RMS of the effort at the axis, in `torque_unit` (N for a linear drive)
    speed     usual speed;  angle  what stands for one radian;  both in `axis_unit`, m or rad
    current   RMS of the effort as read, in `effort_unit`
    mass      that the axis carries [kg];  seconds  of the longest trial
    unseen    way behind a reversal that is over before the filter answers, in `axis_unit`
    """

    torque: float
    speed: float
    angle: float
    stroke: float
    current: float
    mass: float
    torque_unit: str
    effort_unit: str
    axis_unit: str
    seconds: float = 60.0
    unseen: float = 0.0

    def ratio(self, unit: str) -> float:
        """This rig's size over the small rotor's, in the dimension of `unit`."""
        own = {
            "torque": self.torque,
            "speed": self.speed,
            "angle": self.angle,
            "force": self.torque,
            "length": self.stroke,
            "current": self.current,
            "mass": self.mass,
        }
        out = 1.0
        for dimension, power in dimensions(unit).items():
            if dimension in REFERENCE:
                out *= (own[dimension] / REFERENCE[dimension]) ** power
        return out

    def unit(self, unit: str) -> str:
        """What a number in `unit` is given in on this rig."""
        names = {
            "torque": self.torque_unit,
            "speed": f"{self.axis_unit}/s",
            "angle": self.axis_unit,
            "force": self.torque_unit,
            "length": self.axis_unit,
            "current": self.effort_unit,
            "mass": "kg",
            "time": "s",
        }
        over: list[str] = []
        under: list[str] = []
        for dimension, power in dimensions(unit).items():
            name = names.get(dimension, dimension)
            for _ in range(abs(power)):
                (over if power > 0 else under).append(name)
        # a speed below the line is seconds above it
        for _ in range(under.count(f"{self.axis_unit}/s")):
            under[under.index(f"{self.axis_unit}/s")] = self.axis_unit
            over.append("s")
        above = _product(over) or "1"
        below = _product(under)
        below = f"({below})" if "·" in below else below
        return f"{above}/{below}" if below else above

    def parameter(self, about: Parameter) -> Parameter:
        """A declared number for this rig: nominal and bounds moved to its size."""
        ratio = self.ratio(about.unit)
        return replace(
            about,
            nominal=about.nominal * ratio,
            low=about.low * ratio,
            high=about.high * ratio,
            unit=self.unit(about.unit),
        )


def parameters(effect: type[Effect], sizes: Sizes) -> dict[str, Parameter]:
    """The numbers of an effect for a rig of this size.

    A way in which a memory turns round (of a bristle, of play) ends at a small part of the stroke:
    a bristle that never breaks away would imitate any spring, and gravity too.  A number that
    counts periods of an angle begins where the motion holds `PERIODS` of them: part of a wave that
    never came round would imitate any smooth spring.  The numbers of a law that a machine taught
    are that machine's already.
    """
    if effect.taught:
        known = effect.parameters().items()
        return {name: replace(about, unit=sizes.unit(about.unit)) for name, about in known}
    found = {name: sizes.parameter(about) for name, about in effect.parameters().items()}
    if reads_a_disc(effect):
        return _of_a_disc(effect, found, sizes)
    if any(dimensions(about.unit) == HEAT for about in effect.parameters().values()):
        return _of_heat(effect, found, sizes)
    for name, about in found.items():
        if name in ways(effect):
            if shares_inertia(effect):
                low, high = PLAY * sizes.stroke, BRISTLE * sizes.stroke
                found[name] = replace(about, low=low, high=high, nominal=2.0 * low)
                continue
            high = min(about.high, max(BRISTLE * sizes.stroke, 2.0 * about.low))
            found[name] = replace(
                about, high=high, nominal=max(about.low, min(about.nominal, high / 4.0))
            )
        if counts_periods(effect, name):
            least = min(PERIODS * 2 * math.pi * sizes.angle / sizes.stroke, about.high)
            low = max(about.low, least)
            found[name] = replace(about, low=low, nominal=max(about.nominal, low))
    return found


def ways(effect: type[Effect]) -> list[str]:
    """Its numbers that are an angle over which a memory turns round; without that it has none."""
    about = effect.parameters() if effect.state else {}
    return [name for name, one in about.items() if dimensions(one.unit) == {"angle": 1}]


def _of_heat(
    effect: type[Effect], found: dict[str, Parameter], sizes: Sizes
) -> dict[str, Parameter]:
    """The numbers of what warms while it works: at most `HOTTEST` by the end of the longest trial.

    How fast heat goes again is told by trials that are neither much longer nor much shorter.
    """
    for name, about in found.items():
        if dimensions(effect.parameters()[name].unit) == HEAT:
            most = HOTTEST / (sizes.current**2 * sizes.seconds)
            found[name] = replace(about, nominal=about.nominal * most / about.high, high=most)
        elif about.unit == "s":
            low = min(about.low, FASTEST * sizes.seconds)
            found[name] = replace(
                about, low=low, nominal=max(low, min(about.nominal, sizes.seconds))
            )
    return found


def _of_a_disc(
    effect: type[Effect], found: dict[str, Parameter], sizes: Sizes
) -> dict[str, Parameter]:
    """The numbers of a disc that sits off centre by less than `OFF_CENTRE` of its radius.

    It comes round once a turn of the axis or of its motor, or more often, however far the motion
    goes.  On a slide nobody knows but of the motor's turn.
    """
    slowest = min(1.0, sizes.angle) if sizes.axis_unit == "rad" else 1.0
    most = OFF_CENTRE * sizes.angle / slowest
    for name, about in found.items():
        if name in effect.neutral:
            found[name] = replace(about, low=-most, high=most, nominal=0.02 * most)
        elif counts_periods(effect, name):
            found[name] = replace(about, low=WIDER * slowest, nominal=slowest)
    return found


def dimensions(unit: str) -> dict[str, int]:
    """Dimensions of a unit: N·m is torque, rad/s speed, what is left force, length, angle, time."""
    powers: Counter[str] = Counter()
    above, _, below = unit.partition("/")
    found: Counter[str] = Counter()
    for text, sign in ((above, 1), (below, -1)):
        part: Counter[str] = Counter()
        for name, raised in TOKEN.findall(text):
            part[name] += int(raised.translate(SUPERSCRIPT) or 1)
        if part["N"] * part["m"] > 0:
            torque = part["N"]
            found["torque"] += sign * torque
            part["N"] -= torque
            part["m"] -= torque
        for name, power in part.items():
            powers[name] += sign * power
    if powers["rad"] * powers["s"] < 0:
        speed = min(abs(powers["rad"]), abs(powers["s"])) * (1 if powers["rad"] > 0 else -1)
        found["speed"] += speed
        powers["rad"] -= speed
        powers["s"] += speed
    named = {"N": "force", "m": "length", "rad": "angle", "A": "current", "s": "time", "kg": "mass"}
    for name, power in powers.items():
        if power and name != "1":
            found[named.get(name, name)] += power
    return {name: power for name, power in found.items() if power}


def _product(names: list[str]) -> str:
    counted = Counter(names)
    parts = []
    for name, power in counted.items():
        base = f"({name})" if power > 1 and ("·" in name or "/" in name) else name
        parts.append(base + (RAISED.get(power, f"^{power}") if power > 1 else ""))
    return "·".join(parts)


REST = 0.01  # of the fast part of the motion: the scale of a smooth sign


def sizes_of(
    rig: RigFile, body: RigidBody | None, train: Sequence[Recording]
) -> tuple[Sizes, float]:
    """The rig's size in every dimension, from its training trials, and its speed of rest."""

    def gathered(field: str) -> np.ndarray:
        return np.concatenate([getattr(p, field)[p.use] for r in train for p in r.pieces])

    q, v, effort = gathered("q"), gathered("v"), gathered("effort")
    angular = rig.angular
    scale = rig.known.get("scale", rig.fit["scale"].nominal if "scale" in rig.fit else 0.0)
    unit = rig.effort.si
    size = float(np.sqrt(np.mean(effort**2)))
    stroke = float(np.ptp(q))
    gear = rig.gear or (1.0 if angular else 2 * np.pi / stroke)
    sizes = Sizes(
        torque=size * (scale or 1.0),
        speed=float(np.sqrt(np.mean(v**2))),
        angle=1.0 / gear,
        stroke=stroke,
        current=size,
        mass=body.mass if body else 0.1,
        torque_unit=("N·m" if angular else "N") if scale else unit,
        effort_unit=unit,
        axis_unit=rig.axis,
        seconds=max(sum(float(len(p.q)) * r.period for p in r.pieces) for r in train),
        unseen=_unseen(gathered("a"), max(r.cutoff for r in train)),
    )
    if rig.rest_speed is None:
        return sizes, REST * float(np.quantile(np.abs(v), 0.95))
    speed, unit = rig.speed_scale, rig.motion.unit.removesuffix("/s")
    if rig.rest_speed * speed >= sizes.speed:
        raise ConfigError(
            f"rest_speed: {rig.rest_speed:g} is no speed of rest, as the axis moves at "
            f"{sizes.speed / speed:.3g} {unit}/s (RMS); about a hundredth of that is usual"
        )
    return sizes, rig.rest_speed * speed


def _unseen(a: np.ndarray, cutoff: float) -> float:
    """a T²/2: the way from a reversal at the RMS acceleration, a (n,), in the last filter's time.

    T = 1/(2π·edge).  What turns round within it is not told from what flips at once.
    """
    answers = 1.0 / (2.0 * np.pi * BELOW * cutoff)
    return 0.5 * float(np.sqrt(np.mean(a**2))) * answers**2
