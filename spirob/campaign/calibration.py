"""How sure a name may be, learned from cases whose truth is known: `certainty.json`.

    python -m spirob.campaign.calibration cases.jsonl arms.jsonl [--out certainty.json]

Logistic regression of "the name is right" on the figures of `certainty`, over all chosen effects of
all cases, whatever their verdict.  It is judged on each simulator by a fit to the others.
"""

import argparse
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from sklearn.linear_model import LogisticRegression
from sklearn.preprocessing import StandardScaler

from spirob.campaign.arm.rates import ANSWERS
from spirob.diagnosis.certainty import FIGURES
from spirob.files import write_text

STRENGTH = 0.3  # of the weights' prior, inverse: 0.1 to 1 give the same within the cases' noise
BINS = 5  # of the stated probability, in which the calibration error is taken
ARM = "emulated arm"
Line = Mapping[str, Any]
Chosen = tuple[list[float], bool, str]  # figures, whether the name is right, simulator


def effects(lines: Sequence[Line]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Figures (n, 6), whether the name is right (n,) and simulator (n,) of all chosen effects.

    lines  of the campaign of rigs, or results of the trial of arms

    A name that says a part of what is hidden is neither right nor wrong, and left out; so is one
    that is withheld whatever its figures are.
    """
    found = [chosen for line in lines for chosen in (_arm if "evidence" in line else _rig)(line)]
    rows, right, simulators = zip(*found, strict=True)
    return np.array(rows), np.array(right), np.array(simulators)


def _rig(line: Line) -> Iterator[Chosen]:
    truth = line["truth"]
    must = set().union(*truth["must"]) if truth["inside"] else set()
    for chosen in line["features"]["evidence"] if line["features"] else ():
        names = {chosen["name"], *chosen["equivalents"]}
        hit = bool(names & (must | set(truth["besides"])))
        told = chosen.get("probability") != 0.0
        if told and (hit or not names & set(truth["near"])):
            yield [chosen["figures"][name] for name in FIGURES], hit, line["simulator"]


def _arm(line: Line) -> Iterator[Chosen]:
    right = {name for kind in line["kind"].split("+") for name in ANSWERS[kind]}
    for name, one in line["evidence"]["first"].items():
        if one["probability"] > 0.0:
            yield [one["figures"][figure] for figure in FIGURES], name in right, ARM


def read(paths: Sequence[Path]) -> list[Line]:
    """All lines of some files of cases."""
    return [json.loads(line) for path in paths for line in path.read_text().splitlines()]


def digest(paths: Sequence[Path]) -> str:
    """Of all that they hold, one after the other."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()


def learned(rows: np.ndarray, right: np.ndarray, simulators: np.ndarray) -> dict[str, Any]:
    """Means, scales, weights and bias of the regression.

    Each simulator weighs alike: how many cases of it were played says nothing of other machines.
    """
    kinds, number, counts = np.unique(simulators, return_inverse=True, return_counts=True)
    weights = len(right) / (len(kinds) * counts[number])
    scaler = StandardScaler().fit(rows)
    model = LogisticRegression(C=STRENGTH, max_iter=10_000, tol=1e-10)
    model.fit(scaler.transform(rows), right, sample_weight=weights)
    numbers = {"mean": scaler.mean_, "scale": scaler.scale_, "weights": model.coef_[0]}
    told = {name: [float(f"{x:.9g}") for x in values] for name, values in numbers.items()}
    return told | {"bias": float(f"{model.intercept_[0]:.9g}")}


def left_out(rows: np.ndarray, right: np.ndarray, simulators: np.ndarray) -> np.ndarray:
    """Probability of each name by a fit to the other simulators, (n,)."""
    found = np.empty(len(right))
    for one in np.unique(simulators):
        own = simulators == one
        fit = learned(rows[~own], right[~own], simulators[~own])
        scaled = (rows[own] - fit["mean"]) / fit["scale"]
        found[own] = 1.0 / (1.0 + np.exp(-(scaled @ fit["weights"] + fit["bias"])))
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
    parser.add_argument("cases", type=Path, nargs="+", help="lines of spirob trial")
    parser.add_argument("--out", type=Path, help="where the numbers are written")
    given = parser.parse_args()
    lines = read(given.cases)
    rows, right, simulators = effects(lines)
    stated = left_out(rows, right, simulators)
    sure = stated >= 0.9
    print(
        f"{len(lines)} cases, {len(right)} names, {right.mean():.0%} right; calibration error "
        f"{calibration_error(stated, right):.3f} on simulators left out; "
        f"{np.sum(sure & ~right)} of {np.sum(sure)} sure names wrong"
    )
    if given.out:
        about = {
            "cases": [path.name for path in given.cases],
            "sha256": digest(given.cases),
            "seeds": sorted({line["seed"] for line in lines}),
            "figures": list(FIGURES),
        }
        text = json.dumps(about | learned(rows, right, simulators), indent=1)
        write_text(given.out, text + "\n")


if __name__ == "__main__":
    main()
