"""What became of a case: right, right and more, partly, open, missed or wrong."""

from collections.abc import Mapping
from typing import Any

SURE = 0.9  # probability from which a name counts as sure
OPEN = ("undecided", "unknown")
LACKING = ("outside", "taken out")  # groups whose effect no candidate is


def group(result: Mapping[str, Any]) -> str:
    """One of the groups of the table (`spirob.campaign.table.GROUPS`)."""
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
    wrong = [s and e["name"] not in truth["near"] for s, e in zip(strange, effects, strict=True)]
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
