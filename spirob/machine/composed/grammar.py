"""From which terms a law may be composed.

They are shapes of one signal and products of two.  A place may be a power, a spot, a wave or a
curve; a speed has its direction, powers, fading and saturation; time drifts, comes again or decays;
a load counts with sign or without; and what remembers is a bristle, a spring that yields, or what
follows a signal slowly or rings after the motion turns.  A drive may lose a share of its torque, by
any of these or by its own effort.  Numbers of a shape start from a grid;
those of waves where the residual's spectrum has peaks, of ringing where it explains most of it.
"""

import numpy as np

from spirob.diagnosis.orders import PEAKS, peaks, spectrum
from spirob.machine.composed.terms import LOST, WAY, Shape, Term
from spirob.machine.composed.track import Ranges, along

KNOTS = "k"  # of a curve
SPOTS, WIDTHS = 16, (0.06, 0.15, 0.35)  # places of a spot; its half widths over half of the way
FINEST = 100.0  # waves in the way
CARRIED = 12  # peaks that are tried where a wave is a factor: what it multiplies has its own
CENTRES = (-1.0, 0.0, 1.0)  # of half the way, from which the pitch of a wave changes
GROWTHS = (-0.25, 0.25, 0.5, 1.0, 2.0)  # by which it does at half the way from there
CURVES = (6, 12, 24)  # knots
SPEEDS = (0.08, 0.2, 0.5)  # of the fastest, at which something fades or is half there
POWERS = (0.3, 0.6, 1.5)
PERIODS = (0.5, 0.8, 1.2, 1.8)  # of the longest trial
DECAYS = (0.1, 0.3, 1.0)  # of the same
WAYS = (0.01, 0.03, 0.1, 0.3, 0.8)  # of half of the way, in which a bristle turns round
SHORT_WAYS = WAYS[:3]
DELAYS = (0.01, 0.05, 0.2)  # of the longest trial
SHARE = 0.1  # of the largest load, that a friction at the fastest is
HALVES = (0.03, 0.2, 0.6)  # of the same, at which half of what levels off is there
EXPONENTS = (0.5, 1.0, 2.0, 3.0)  # of the effort
BANDS = (0.01, 0.03, 0.1, 0.3)  # of the largest effort, that do nothing
SHORTEST, LONGEST = 4.0, 0.1  # period of what rings: in samples, of the longest trial
FINE = 1.12  # from one such period to the next
FADES = (0.5, 2.0)  # periods in which it fades


def _one(kind: str, of: str, *parts: str) -> Shape:
    return Shape(kind, of, parts)


STANDING = "speed/rest_speed"  # within one
DIRECTION = _one(WAY, "speed", "way")
ONE_WAY = {"forward": "Max(0.0, way)", "backward": "Min(0.0, way)"}
PLAIN = {
    "line": _one("line", "speed", "line"),
    "share": _one("share", "speed", "share"),
    "drag": _one("drag", "speed", "way*share**2"),
    "lift": _one("lift", "speed", "share**2"),
    "steady": _one("steady", "", "1.0"),
    "far": _one("far", "place", "away"),
    "far2": _one("far2", "place", "away**2"),
    "far3": _one("far3", "place", "away**3"),
    "cubic": _one("cubic", "place", "away", "away**2", "away**3"),
    "sprung": _one("cubic about any place", "place", "1.0", "away", "away**2", "away**3"),
    "late": _one("late", "time", "late"),
    "late2": _one("late2", "time", "late**2"),
    "weight": _one("weight", "load", "Abs(pull)"),
    "pull": _one("pull", "load", "pull"),
}
STRAIGHT = [PLAIN[name] for name in ("far", "far2", "far3", "cubic")]
WORKS = {"driving": "", "driven": "-"}  # where the drive makes the motion, and where it is moved
GIVEN = "(pull + m*line)"  # what a motor gives: the load, and a friction in proportion to speed


def terms(
    ranges: Ranges, residual: np.ndarray, signals: dict[str, np.ndarray], placed: bool
) -> list[Term]:
    """All terms from which a law beside the drive may begin.

    residual  (N,) that is to be explained;  signals  `place`, `speed` and so on along it
    """
    odd, even = _speeds(ranges, odd=True), _speeds(ranges, odd=False)
    places = _places(ranges, residual, signals) if placed else []
    times = _times(ranges)
    found = [Term((s,)) for s in (PLAIN["steady"], *odd, *even)]
    found += [Term((s,)) for s in (*places, *times, *[PLAIN["sprung"]] * placed)]
    found += [Term((DIRECTION, s)) for s in _swells(ranges)]
    for speed in (DIRECTION, PLAIN["line"], PLAIN["share"]):
        carried = _carried(speed, ranges, residual, signals)
        own = _places(ranges, carried, signals) if placed else []
        found += [Term((speed, s)) for s in (*own, *times)]
    if placed:
        carried = residual * signals["load"] / ranges.heavy
        own = [*STRAIGHT, *_waves(ranges, carried, signals["place"], CARRIED)]
        own += map(curve, CURVES)
        found += [Term((_given("given", GIVEN), s)) for s in own]
    found += _loads(ranges) + _memories(ranges, placed)
    return [*found, _ringing(ranges, residual, signals)]


def _carried(
    speed: Shape, ranges: Ranges, residual: np.ndarray, signals: dict[str, np.ndarray]
) -> np.ndarray:
    """The residual times what multiplies a shape of the place, whose spectrum shows its waves."""
    v = signals["speed"]
    return residual * (np.abs(v) if speed.kind == "share" else np.tanh(v / ranges.rest_speed))


def _speeds(ranges: Ranges, odd: bool) -> list[Shape]:
    fast = ranges.fast
    wide = (ranges.rest_speed, 2.0 * fast)

    def made(kind: str, text: str, key: str, value: float, box: tuple[float, float]) -> Shape:
        whole = f"way*{text}" if odd else text
        return Shape(kind if odd else f"even {kind}", "speed", (whole,), ((key, value),), (box,))

    found = [DIRECTION, PLAIN["drag"]] if odd else [PLAIN["share"], PLAIN["lift"]]
    found += [made("power", "share**p", "p", p, (0.05, 4.0)) for p in POWERS]
    found += [made("fading", "exp(-(speed/f)**2)", "f", s * fast, wide) for s in SPEEDS]
    if odd:
        texts = [(name, f"{way}*exp(-(speed/f)**2)") for name, way in ONE_WAY.items()]
        found += [
            Shape(f"{name} fading", "speed", (text,), (("f", s * fast),), (wide,))
            for name, text in texts
            for s in SPEEDS
        ]
    found += [made("settling", "Abs(speed)/(Abs(speed) + s)", "s", s * fast, wide) for s in SPEEDS]
    return found


def _places(ranges: Ranges, residual: np.ndarray, signals: dict[str, np.ndarray]) -> list[Shape]:
    middle, half = ranges.middle, ranges.half
    found = list(STRAIGHT)
    round_again = 0.0 < ranges.turn < 2 * half
    text = "exp(-0.5*((place - c)/w)**2)"
    if round_again:
        text = "exp(-0.5*(turn*sin(pi*(place - c)/turn)/(pi*w))**2)"
    way = min(ranges.turn / 2 if round_again else half, half)
    box = (middle - half, middle + half), (0.02 * way, way)
    for centre in np.linspace(middle - half, middle + half, SPOTS + 2)[1:-1]:
        for width in WIDTHS:
            numbers = ("c", float(centre)), ("w", width * way)
            found.append(
                Shape("turning spot" if round_again else "spot", "place", (text,), numbers, box)
            )
    found += _waves(ranges, residual, signals["place"])
    found += [_chirp(ranges, c, residual, signals["place"]) for c in CENTRES]
    return found + [curve(count) for count in CURVES]


def _orders(ranges: Ranges) -> tuple[float, float]:
    """Lowest and highest order of a wave [rad of it in a unit of the place]."""
    return 0.5 * np.pi / ranges.half, FINEST * np.pi / ranges.half


def _waves(
    ranges: Ranges, residual: np.ndarray, place: np.ndarray, count: int = PEAKS
) -> list[Shape]:
    half, parts = ranges.half, ("cos(2*pi*place/L)", "sin(2*pi*place/L)")
    box = ((2 * half / FINEST, 4 * half),)
    orders = peaks(residual, place, *_orders(ranges), count)
    return [Shape("wave", "place", parts, (("L", 2 * np.pi / order),), box) for order in orders]


def _chirp(
    ranges: Ranges,
    centre: float,
    residual: np.ndarray,
    place: np.ndarray,
) -> Shape:
    """A wave whose pitch changes away from a place [of half the way], begun where it shows most."""
    half, c = ranges.half, ranges.middle + centre * ranges.half
    away, best = place - c, (-1.0, 0.0, 0.0)
    for growth in GROWTHS:
        orders, power = spectrum(
            residual, away * (1 + growth * np.abs(away) / half), *_orders(ranges)
        )
        if len(orders):
            k = int(np.argmax(power))
            best = max(best, (float(power[k]), growth, 2 * np.pi / float(orders[k])))
    inner = "2*pi*(place - c)*(1 + g*Abs(place - c)/half)/L"
    numbers = ("c", c), ("g", best[1]), ("L", best[2] or half)
    box = (ranges.middle - half, ranges.middle + half), (-0.25, 4.0), (2 * half / FINEST, 4 * half)
    return Shape("chirp", "place", (f"cos({inner})", f"sin({inner})"), numbers, box)


def curve(count: int) -> Shape:
    """A smooth curve over the way through so many heights, evenly apart."""
    at = f"{0.5 * (count - 1)!r}*(far + 1.0)"
    parts = [f"(0.5 + 0.5*cos(pi*Max(-1.0, Min(1.0, {at} - {float(k)!r}))))" for k in range(count)]
    return Shape(f"curve {KNOTS}{count}", "place", tuple(parts))


def _times(ranges: Ranges) -> list[Shape]:
    long = ranges.long
    found = [PLAIN["late"], PLAIN["late2"]]
    waves = "cos(2*pi*time/T)", "sin(2*pi*time/T)"
    box = ((0.05 * long, 2.0 * long),)
    found += [Shape("tide", "time", waves, (("T", p * long),), box) for p in PERIODS]
    box = ((0.01 * long, 3.0 * long),)
    found += [Shape("decay", "time", ("exp(-time/d)",), (("d", d * long),), box) for d in DECAYS]
    return found


def _swells(ranges: Ranges) -> list[Shape]:
    """What comes and goes with time about a level of its own."""
    swells = [s for s in _times(ranges) if s.kind == "tide"]
    return [Shape("swell", "time", ("1.0", *s.parts), s.numbers, s.box) for s in swells]


def _loads(ranges: Ranges) -> list[Term]:
    odd, even = _speeds(ranges, odd=True), _speeds(ranges, odd=False)
    weight, pull = PLAIN["weight"], PLAIN["pull"]
    levelling = f"{GIVEN}/(Abs{GIVEN} + u)"
    return [
        Term((DIRECTION, _given("passed", f"Abs{GIVEN}"))),
        Term((_given("hard", f"{GIVEN}*{GIVEN}**2"),)),
        *(Term((_given("levelling", levelling, ("u", u)),)) for u in HALVES),
        Term((weight,)),
        Term((pull,)),
        *(Term((weight, s)) for s in odd),
        *(Term((pull, s)) for s in even),
        *(Term((pull, PLAIN[name])) for name in ("late", "late2")),
    ]


def losses(
    ranges: Ranges, residual: np.ndarray, signals: dict[str, np.ndarray], placed: bool
) -> list[Term]:
    """All from which a law of the drive may begin; none where no drive makes the effort.

    They are shares of its torque that it loses: by its effort, its work, speed, place or time.
    """
    if "current" not in signals:
        return []
    found = [_one("working", "effort", "working")]
    found += [_one(kind, "effort", f"Max(0.0, {sign}working)") for kind, sign in WORKS.items()]

    def made(kind: str, text: str, numbers: dict[str, float], *box: tuple[float, float]) -> Shape:
        memory = ("slow", "strength**2") if "slow" in text else ("", "")
        of = "memory" if memory[0] else "effort"
        return Shape(kind, of, (text,), tuple(numbers.items()), box, *memory)

    power, half, delay = (0.2, 6.0), (1e-3, 4.0), (0.001 * ranges.long, 3.0 * ranges.long)
    settling, dead = "strength**n/(strength**n + h**n)", "Min(1.0, z/Max(strength, 1e-9))"
    found += [made("effort power", "strength**n", {"n": n}, power) for n in EXPONENTS]
    found += [
        made("effort settling", settling, {"n": n, "h": h}, power, half)
        for h in HALVES
        for n in (1.0, 2.0)
    ]
    found += [made("dead band", dead, {"z": z}, (1e-4, 0.9)) for z in BANDS]
    found += [
        made(
            "slow warmth", "slow/(slow + h)", {"e": d * ranges.long, "h": 1.0}, delay, (1e-3, 10.0)
        )
        for d in DELAYS
    ]
    found += [*_speeds(ranges, odd=False), *_times(ranges)]
    if placed:
        carried = residual * signals["current"] / ranges.strong
        found += [*STRAIGHT, *_waves(ranges, carried, signals["place"], CARRIED)]
        found += map(curve, CURVES)
    return [Term((LOST, s)) for s in found]


def _given(kind: str, text: str, *more: tuple[str, float]) -> Shape:
    """A function of what the motor gives."""
    box = ((0.0, 4.0), (1e-3, 4.0))[: 1 + len(more)]
    return Shape(kind, "load", (text,), (("m", SHARE), *more), box)


def _memories(ranges: Ranges, placed: bool) -> list[Term]:
    half, long = ranges.half * ranges.gear if placed else ranges.fast, ranges.long
    found = []
    for kind in ("bristle", "spring"):
        for way in WAYS:
            numbers, box = (("r", way * half),), (_reach(half),)
            shape = Shape(kind, "memory", ("bend",), numbers, box, kind, "speed")
            found.append(Term((shape,)))
            if kind == "bristle":
                found.append(Term((shape, PLAIN["weight"])))
    box = ((0.001 * long, 3.0 * long),)
    followed = {"way": "direction", "share": "speed", "pull": "load"}
    followed |= {"away": "place"} if placed else {}
    for text, name in followed.items():
        for delay in DELAYS:
            numbers = (("e", delay * long),)
            shape = Shape(f"slow {name}", "memory", ("slow",), numbers, box, "slow", text)
            found.append(Term((shape,)))
    given = _given("given", GIVEN)
    for delay in DELAYS:
        own, both = (*given.numbers, ("e", delay * long)), (*given.box, *box)
        heat = Shape("slow heat", "memory", ("slow",), own, both, "slow", f"{GIVEN}**2")
        found += [Term((heat,)), Term((heat, given))]
    return found


def _ringing(ranges: Ranges, residual: np.ndarray, signals: dict[str, np.ndarray]) -> Term:
    """What rings after the motion turns, begun where it explains most of the residual."""
    time = signals["time"]
    between = np.diff(time)
    step = float(np.median(between[between > 0.0]))
    starts = np.concatenate([[0], np.flatnonzero(between <= 0.0) + 1, [len(time)]])
    steps = np.full(len(starts) - 1, step)
    since, side = along("turn", signals["speed"] / ranges.rest_speed, (), starts, steps)
    longest = max(LONGEST * ranges.long, 2.0 * SHORTEST * step)
    count = int(np.log(longest / (SHORTEST * step)) / np.log(FINE)) + 1
    best, at = -1.0, (longest, longest)
    for period in np.geomspace(SHORTEST * step, longest, count):
        for fade in FADES:
            wave = side * np.exp(-since / (fade * period) + 2j * np.pi * since / period)
            share = _explained(residual, np.column_stack([wave.real, wave.imag]))
            best, at = max((best, at), (share, (float(period), fade * float(period))))
    fading = "side*exp(-since/d)"
    parts = f"{fading}*cos(2*pi*since/T)", f"{fading}*sin(2*pi*since/T)"
    numbers = ("T", at[0]), ("d", at[1])
    box = ((SHORTEST * step, 2.0 * longest), (SHORTEST * step, ranges.long))
    return Term((Shape("ringing", "memory", parts, numbers, box, "turn", STANDING),))


def _explained(residual: np.ndarray, columns: np.ndarray) -> float:
    """Square of what the columns, (N, k), explain of the residual."""
    columns = columns / (np.linalg.norm(columns, axis=0) + 1e-300)
    along_them = columns.T @ residual
    inner = columns.T @ columns + 1e-9 * np.eye(columns.shape[1])
    return float(along_them @ np.linalg.solve(inner, along_them))


def bristled(term: Term, ranges: Ranges) -> list[Term]:
    """The term with bristles of several short ways for its direction, none where it has none."""
    half = ranges.half * ranges.gear
    found = [term.bristled(way * half, _reach(half)) for way in SHORT_WAYS]
    return [one for one in found if one is not None]


def _reach(half: float) -> tuple[float, float]:
    return 0.0005 * half, 4.0 * half
