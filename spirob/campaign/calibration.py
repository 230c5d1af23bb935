"""How sure a name may be, learned from cases whose truth is known: `certainty.json`.

    python -m spirob.campaign.calibration name cases.jsonl fresh.jsonl [--out certainty.json]
    python -m spirob.campaign.calibration arm arms.jsonl typical.jsonl [--out certainty.json]
    python -m spirob.campaign.calibration proof cases.jsonl typical.jsonl [--out certainty.json]

A logistic regression on the figures of `certainty` and on which name it is, over all chosen effects
of all cases, whatever their verdict: of "the name is right", or of "it says at least a part of what
is right", which is what its "kin" is judged by.  That of a "proof" knows how much of it the names
of a case account for, and nothing else.  It is judged on each simulator by a fit to the others; of
arms, which one emulator plays, on each robot by a fit to the others.
"""

import argparse
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from sklearn.linear_model import LogisticRegression
from sklearn.preprocessing import StandardScaler

from spirob.campaign.arm.rates import answers
from spirob.campaign.scoring import near_names
from spirob.diagnosis.certainty import FIGURES, LIKELY
from spirob.files import write_text

# Variance of the weights' prior, with which robots or simulators left out are told best: 0.1 to 1
# give the same within the cases' noise, of a proof's one weight 1 and more.
STRENGTH, OF_PROOF = 0.3, 3.0
BINS = 5  # of the stated probability, in which the calibration error is taken
Line = Mapping[str, Any]
Chosen = tuple[Mapping[str, float], str, str, str]  # figures; name; right, near, wrong; whose


@dataclass(frozen=True)
class Names:
    """Chosen effects whose truth is known.

    rows  figures, (n, 6);  names  of the effects, (n,);  right  whether they are, (n,)
    whose  (n,), a rig's simulator, behind "disturbed/" where it was, or "emulated arm/" and the
           number of one robot: what weighs alike, and what is left out to judge
    """

    rows: np.ndarray
    names: np.ndarray
    right: np.ndarray
    whose: np.ndarray

    def of(self, kept: np.ndarray) -> "Names":
        """Some of them."""
        return Names(self.rows[kept], self.names[kept], self.right[kept], self.whose[kept])


def effects(lines: Sequence[Line], of: str = "name") -> Names:
    """All chosen effects.

    lines  of the campaign of rigs, or results of the trial of arms
    of     "name", "arm", "kin", or "proof": what is named of a case, as one

    A name that says a part of what is hidden is neither right nor wrong, and left out; of its kin
    it is right.  What is withheld whatever its figures are is left out of both.
    """
    found = [chosen for line in lines for chosen in _of(line, of)]
    counted = ("right", "near", "wrong") if of == "kin" else ("right", "wrong")
    names = FIGURES[of]
    kept = [one for one in found if one[2] in counted and set(names) <= set(one[0])]
    figures, called, said, whose = zip(*kept, strict=True)
    rows = np.array([[one[name] for name in names] for one in figures])
    return Names(rows, np.array(called), np.array(said) != "wrong", np.array(whose))


def _of(line: Line, of: str) -> Iterator[Chosen]:
    if of == "proof":
        return _proof(line)
    return _arm(line) if "evidence" in line else _rig(line)


def _rig(line: Line) -> Iterator[Chosen]:
    truth = line["truth"]
    must = set().union(*truth["must"]) if truth["inside"] else set()
    right, near = must | set(truth["besides"]), near_names(truth)
    for chosen in line["features"]["evidence"] if line["features"] else ():
        names = {chosen["name"], *chosen["equivalents"]}
        if chosen.get("probability") != 0.0:
            said = "right" if names & right else "near" if names & near else "wrong"
            whose = "disturbed/" * line.get("disturbed", False) + line["simulator"]
            yield chosen["figures"], chosen["name"], said, whose


def _arm(line: Line) -> Iterator[Chosen]:
    right = answers(line["kind"])
    for name, one in line["evidence"]["first"].items():
        if one["probability"] > 0.0:
            yield (
                one["figures"],
                name,
                "right" if name in right else "wrong",
                f"emulated arm/{line['robot']}",
            )


def _proof(line: Line) -> Iterator[Chosen]:
    """What is named, or was before the proof; of results that do not tell, what comes first."""
    if line.get("proof"):
        before = line["evidence"]["first"] if "evidence" in line else {}
        told = [name for name, one in before.items() if one["together"] >= LIKELY]
        names = set(line["named"] or told or line["first"][:1])
        said = "right" if names <= set(answers(line["kind"])) else "wrong"
        share = min(max(line["proof"]["share"], 0.0), 1.0)
        yield {"share": share}, "", said, f"emulated arm/{line['robot']}"


def read(paths: Sequence[Path]) -> list[Line]:
    """All lines of some files of cases."""
    return [json.loads(line) for path in paths for line in path.read_text().splitlines()]


def digest(paths: Sequence[Path]) -> str:
    """Of all that they hold, one after the other."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()


def learned(cases: Names, strength: float = STRENGTH) -> dict[str, Any]:
    """Means, scales, weights, bias and what is added for each name, of the regression.

    Also "before", the logarithm of the odds that any is right, whatever its figures.
    `strength` is the variance of the weights' prior.
    Each simulator weighs alike, and disturbed machines as one more: how many cases of it were
    played says nothing of other machines.
    A name's own number is drawn to zero as the weights are, so that a few cases of it say little.
    """
    simulators = [one.split("/")[0] for one in cases.whose]
    kinds, number, counts = np.unique(simulators, return_inverse=True, return_counts=True)
    weights = len(number) / (len(kinds) * counts[number])
    scaler, called = StandardScaler().fit(cases.rows), sorted({*cases.names.tolist()} - {""})
    model = LogisticRegression(C=strength, max_iter=10_000, tol=1e-10)
    which = cases.names[:, None] == np.array(called, dtype=str)
    columns = np.hstack([scaler.transform(cases.rows), which])
    model.fit(columns, cases.right, sample_weight=weights)
    slopes, own = np.split(model.coef_[0], [cases.rows.shape[1]])
    numbers = {"mean": scaler.mean_, "scale": scaler.scale_, "weights": slopes}
    told = {name: [_rounded(x) for x in values] for name, values in numbers.items()}
    return told | {
        "bias": _rounded(model.intercept_[0]),
        "before": _rounded(np.log(weights @ cases.right / (weights @ ~cases.right))),
        "names": {name: _rounded(x) for name, x in zip(called, own, strict=True)},
    }


def _rounded(number: float) -> float:
    return float(f"{number:.9g}")


def left_out(cases: Names, strength: float = STRENGTH) -> np.ndarray:
    """Probability of each name by a fit to the other simulators, or robots, (n,)."""
    found, left = np.empty(len(cases.right)), np.array([w.split("/")[-1] for w in cases.whose])
    for one in np.unique(left):
        own = left == one
        fit = learned(cases.of(~own), strength)
        scaled = (cases.rows[own] - fit["mean"]) / fit["scale"]
        added = [fit["names"].get(name, 0.0) for name in cases.names[own]]
        found[own] = 1.0 / (1.0 + np.exp(-(scaled @ fit["weights"] + fit["bias"] + added)))
    return found


def calibration_error(stated: np.ndarray, right: np.ndarray) -> float:
    """Mean distance of stated and found rates, over five bins weighted by their cases."""
    bins = np.minimum((stated * BINS).astype(int), BINS - 1)
    parts = [bins == k for k in range(BINS)]
    off = [abs(stated[b].mean() - right[b].mean()) * b.sum() for b in parts if b.any()]
    return float(sum(off) / len(right))


def main() -> None:
    """Fit, judge, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("of", choices=FIGURES, help="what has to be right")
    parser.add_argument("cases", type=Path, nargs="+", help="lines of spirob trial")
    parser.add_argument("--out", type=Path, help="where its numbers are put")
    given = parser.parse_args()
    lines = read(given.cases)
    cases, strength = effects(lines, given.of), OF_PROOF if given.of == "proof" else STRENGTH
    stated, right = left_out(cases, strength), cases.right
    sure = stated >= 0.9
    print(
        f"{len(lines)} cases, {len(right)} names, {right.mean():.0%} right; calibration error "
        f"{calibration_error(stated, right):.3f} on simulators or robots left out; "
        f"{np.sum(sure & ~right)} of {np.sum(sure)} sure names wrong"
    )
    if given.out:
        about = {
            "cases": [f"{path.parent.name}/{path.name}" for path in given.cases],
            "sha256": digest(given.cases),
            "seeds": sorted({line["seed"] for line in lines}),
            "figures": list(FIGURES[given.of]),
        }
        whole = json.loads(given.out.read_text()) if given.out.exists() else {}
        whole[given.of] = about | learned(cases, strength)
        write_text(given.out, json.dumps(whole, indent=1) + "\n")


if __name__ == "__main__":
    main()
