"""The table of a campaign: what became of the cases, each rate with its 95 % interval (Wilson)."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from spirob.campaign.scoring import LACKING, group
from spirob.trial.rates import rate

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
WITHIN = (1.3, 2.0)  # times the held-out error of the true law


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
