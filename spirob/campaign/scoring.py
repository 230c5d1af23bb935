"""The answer key, what became of each case, and the table of a campaign with its rates (Wilson)."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from spirob.campaign.arm.rates import WITHIN, rate


@dataclass(frozen=True)
class Kind:
    """What a kind is called.

    family   of which an axis has one at a time: two of them would be a third
    names    of the library that are right, each by itself; none where it holds no such effect
    besides  names that may stand beside a right one, as the machine is that, too
    near     names that say a part of it: neither right nor wrong
    """

    family: str
    names: frozenset[str] = frozenset()
    besides: frozenset[str] = frozenset()
    near: frozenset[str] = frozenset()


def _kind(family: str, names: str = "", near: str = "") -> Kind:
    return Kind(family, frozenset(names.split()), near=frozenset(near.split()))


DRY = "coulomb_friction stribeck_friction presliding_friction"
LOSS = "load_dependent_friction direction_dependent_efficiency"
CONSTANT = "constant_force current_offset"

KINDS: dict[str, Kind] = {
    "coulomb_friction": _kind("dry", "coulomb_friction", DRY),
    "stribeck_friction": _kind("dry", "stribeck_friction", DRY),
    "presliding_friction": _kind("dry", "presliding_friction", DRY),
    "load_dependent_friction": _kind("loss", LOSS),
    "direction_dependent_efficiency": _kind("loss", LOSS),
    "asymmetric_viscous_friction": _kind("asymmetric", "asymmetric_viscous_friction"),
    "quadratic_drag": _kind("drag", "quadratic_drag"),
    "cogging": _kind("wave", "cogging"),
    "torque_ripple": _kind("wave", "torque_ripple"),
    "tip_payload": _kind("weight", "tip_payload"),
    "parallel_spring": _kind("weight", "parallel_spring"),
    "constant_force": _kind("constant", CONSTANT),
    "current_offset": _kind("constant", CONSTANT),
    "current_gain": _kind("gain", "current_gain"),
    "current_lag": _kind("late", "current_lag"),
    "feedback_latency": _kind("late", "feedback_latency"),
    "driver_dead_band": _kind("command", "driver_dead_band"),
    "torque_constant_saturation": _kind("iron", "torque_constant_saturation"),
    "winding_heating": _kind("heat", "winding_heating"),
    "gear_compliance": _kind("shaft", "gear_compliance"),
    "backlash": _kind("shaft", "backlash", "gear_compliance"),
    "encoder_eccentricity": _kind("wave", "encoder_eccentricity"),
    # what no effect of the library is
    "position_viscosity": _kind("drag"),
    "drifting_friction": _kind("dry", near=DRY),
    "power_friction": _kind("dry"),
    "progressive_spring": _kind("weight", near="parallel_spring"),
    "tight_spot": _kind("dry", near=DRY),
    "hysteretic_spring": _kind("weight", near="presliding_friction parallel_spring"),
    "chirped_magnets": _kind("wave"),
    "speed_efficiency": _kind("iron"),
    # F where it moves forward is F/2 both ways and the constant force F/2
    "stick_one_way": _kind("dry", near=f"{DRY} {CONSTANT}"),
    "loose_screw": _kind("shaft"),
}
LIBRARY = tuple(name for name, kind in KINDS.items() if kind.names)
OUTSIDE = tuple(name for name, kind in KINDS.items() if not kind.names)
# drawn with the seed: two and three of the library; one of it, and less of one that it lacks
NONE, TWO, THREE, BESIDE = "none", "two", "three", "beside"
DRAWN = {TWO: 2, THREE: 3, BESIDE: 1}  # how many of the library
# sizes of a current's reading, which no description tells from its scale
NO_PARTNER = frozenset({"current_gain", "current_lag", "feedback_latency"})


def near_names(truth: Mapping[str, Any]) -> set[str]:
    """Names that say a part of what is hidden, by the key and by that of the case's day."""
    return set(truth["near"]).union(*(KINDS[kind].near for kind in truth["hidden"]))


def answers(kind: str, bristles: bool, one_way: bool) -> Kind:
    """What counts as right for a kind in one machine.

    bristles  its dry friction always turns round over a way: Coulomb friction is presliding, too
    one_way   it moved one way in all logs: dry friction is then a constant force
    """
    known = KINDS[kind]
    names, besides = known.names, known.besides
    if bristles and kind == "coulomb_friction":
        names = names | {"presliding_friction"}
    if bristles and kind == "stribeck_friction":
        besides = besides | {"presliding_friction"}
    if one_way and known.family in ("dry", "constant") and known.names:
        names = names | set(CONSTANT.split()) | {"coulomb_friction", "presliding_friction"}
    return Kind(known.family, names, besides, known.near - names)


SURE = 0.9  # probability from which a name counts as sure
LACKING = ("outside", "taken out")  # groups whose effect no candidate is


def group(result: Mapping[str, Any]) -> str:
    """One of the groups of the table (`spirob.campaign.scoring.GROUPS`)."""
    truth = result["truth"]
    if not truth["hidden"]:
        return "none"
    if not truth["can_be_shown"]:
        return "not to be seen"
    if not truth["inside"]:
        return "outside"
    if truth.get("beside"):
        return "one beside"
    if result.get("without"):
        return "taken out"
    return {1: "one", 2: "two", 3: "three"}[len(truth["hidden"])]


def outcome(result: Mapping[str, Any]) -> dict[str, Any]:
    """How a result is counted; every value is a bool but `word`.

    exactly    named, everything that is hidden and nothing besides; or rightly nothing, or open
    first      named, and the first name is right
    more       named, everything that is hidden, and something that is not
    among      undecided, with every right name among those in question
    partly     named, nothing wrong but names that say a part of it
    sure_wrong named, and a name that is neither right nor a part with a probability of 0.9 and more
               (of one effect and more: the first name)
    word       one of exactly, more, first, partly, undecided, unknown, missed, wrong, refused,
               crashed
    """
    for word in ("refused", "crashed"):
        if result[word]:
            return _made(word)
    truth, verdict = result["truth"], result["said"]["verdict"]
    effects = result["said"]["effects"] if verdict in ("named", "undecided") else []
    named = [{e["name"], *e["equivalents"]} for e in effects]
    kind = group(result)
    must = [set(names) for names in truth["must"]] if kind not in LACKING else []
    right = set().union(*must) | set(truth["besides"])
    every = all(any(names & wanted for names in named) for wanted in must)
    strange = [not names & right for names in named]
    near = near_names(truth)
    wrong = [s and e["name"] not in near for s, e in zip(strange, effects, strict=True)]
    sure = [e["probability"] >= SURE for e in effects]
    if verdict == "undecided":
        asked = [n | set(e["rivals"]) for n, e in zip(named, effects, strict=True)]
        found = bool(must) and all(any(a & wanted for a in asked) for wanted in must)
        return _made("exactly" if kind in LACKING else "undecided", among=found)
    if verdict == "unknown":
        return _made("exactly" if kind in LACKING else "unknown")
    if verdict == "nothing_missing":
        return _made("exactly" if kind in ("none", "not to be seen") else "missed")
    if kind == "none" or kind in LACKING:
        word = "wrong" if any(wrong) else "partly"
        return _made(word, sure_wrong=any(w and s for w, s in zip(wrong, sure, strict=True)))
    first = bool(named) and bool(named[0] & set().union(*must))
    if kind == "not to be seen":
        every = every or (any(named) and not any(strange))
    if every and not any(strange):
        return _made("exactly", first=first)
    told = "more" if every else "first" if first else "wrong" if any(wrong) else "partly"
    return _made(told, first=first, sure_wrong=bool(not first and wrong[0] and sure[0]))


def _made(word: str, **flags: bool) -> dict[str, Any]:
    plain = {"first": False, "among": False, "sure_wrong": False}
    return {"word": word, **plain, **flags}


GROUPS = (
    "one",
    "one beside",
    "two",
    "three",
    "none",
    "outside",
    "taken out",
    "not to be seen",
)
WORDS = ("more", "partly", "undecided", "unknown", "missed", "wrong", "refused", "crashed")


def rates(results: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Of each group, over all simulators and of each: how many cases, and the rates of `row`."""
    simulators = sorted({r["simulator"] for r in results})
    table: dict[str, Any] = {}
    for name in GROUPS:
        chosen = [r for r in results if group(r) == name]
        if chosen:
            each = {s: [r for r in chosen if r["simulator"] == s] for s in simulators}
            table[name] = {"all": row(chosen)} | {s: row(rs) for s, rs in each.items() if rs}
    return table


def row(results: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Rates of some cases of one group; `words` counts what became of the others."""
    outcomes = [r["outcome"] for r in results]
    words = Counter(o["word"] for o in outcomes)
    return {
        "n": len(results),
        "exactly": rate(o["word"] == "exactly" for o in outcomes),
        "first": rate(o["first"] for o in outcomes),
        "sure_wrong": rate(o["sure_wrong"] for o in outcomes),
        "among": sum(o["among"] for o in outcomes),
        "words": {word: words[word] for word in WORDS if words[word]},
    }


def lines(table: Mapping[str, Any]) -> list[str]:
    """The table as text."""
    head = f"{'hidden':16s}{'simulator':11s}{'n':>5s}  {'exactly right':22s}"
    out = [f"{head}{'right name first':22s}{'wrong and sure':22s}otherwise"]
    for name, rows in table.items():
        for simulator, one in rows.items():
            words = ", ".join(f"{n} {word}" for word, n in one["words"].items())
            told = [_told(one[key]) for key in ("exactly", "first", "sure_wrong")]
            if name in ("none", *LACKING, "not to be seen"):
                told[1] = ""
            shown = "".join(f"{text:22s}" for text in told)
            out.append(f"{name:16s}{simulator:11s}{one['n']:5d}  {shown}{words}".rstrip())
    return out


def laws(results: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Of each group: how often a law was composed, and its held-out error over the true law's.

    Where no law was composed the error is that of what was said instead.  Results of a program that
    composed none are left out.
    """
    known = [r for r in results if r.get("heldout")]
    table = {}
    for name in GROUPS:
        chosen = [r for r in known if group(r) == name]
        if not chosen:
            continue
        over = [ratio for r in chosen if (ratio := over_true(r)) is not None]
        table[name] = {
            "n": len(chosen),
            "composed": rate(r["composed"] is not None for r in chosen),
            "within": {str(most): rate(ratio <= most for ratio in over) for most in WITHIN},
        }
    return table


def over_true(result: Mapping[str, Any]) -> float | None:
    """The held-out error over the one that knowing leaves; None where that is not known."""
    found = result["heldout"]
    if not found["true"]:
        return None
    return float((found["said"] if found["law"] is None else found["law"]) / found["true"])


def law_lines(table: Mapping[str, Any]) -> list[str]:
    """The table of composed laws as text."""
    heads = "".join(f"{f'≤ {most} × true':22s}" for most in WITHIN)
    out = [f"{'hidden':16s}{'n':>5s}  {'law composed':22s}{heads}".rstrip()]
    for name, one in table.items():
        told = [one["composed"], *one["within"].values()]
        shown = "".join(f"{_told(r) if r['n'] else '':22s}" for r in told)
        out.append(f"{name:16s}{one['n']:5d}  {shown}".rstrip())
    return out


def _told(one: Mapping[str, Any]) -> str:
    return f"{one['value']:.1%} [{one['low']:.0%}, {one['high']:.0%}]"
