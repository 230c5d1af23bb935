"""Composed laws beside PySINDy and a symbolic regression, given the same signals and logs.

    python -m spirob.campaign.other_laws --seeds S [S ...] --out FILE.jsonl

Each case of the campaign whose effect the library lacks is taken with its delay known, so that all
three see the same rows.  They get what the fitted numbers leave of the training logs and the
motion that leaves it (place, speed, direction, load, time; sizes as `track` has them), and are
judged by the held-out log.  The fitted numbers move with each law, by their slopes.  It needs the
extra `laws` (pysindy and pyoperon).
"""

import argparse
import json
import re
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from spirob.campaign.case import Case, drawn
from spirob.campaign.scoring import OUTSIDE
from spirob.campaign.simulators import SIMULATORS
from spirob.campaign.true_law import based
from spirob.machine.composed import composed, ground
from spirob.machine.composed.draft import Drafts
from spirob.machine.composed.track import Ranges

THRESHOLDS = (0.003, 0.01, 0.03, 0.1, 0.3)  # of the target's size, with columns of one size
DEGREE, WAVES = 3, 12  # of polynomials; periods of the way
SECONDS, ROWS = 20, 3000  # of a symbolic regression
SYMBOLS = "add,sub,mul,div,constant,variable,abs,square,sqrt,exp,tanh,sin,cos"


@dataclass(frozen=True)
class Samples:
    """The samples of one role.

    left    (N,) what the fitted numbers leave;  slopes  (N, n) of it by those numbers
    motion  (N, 5) place, speed, direction, load and time in sizes of one
    """

    left: np.ndarray
    slopes: np.ndarray
    motion: np.ndarray

    def after(self, other: "Samples", own: np.ndarray, held: np.ndarray) -> float:
        """RMS of `other` once columns `own`, `held` there, and the slopes are fitted here."""
        columns = np.hstack([self.slopes, own])
        size = np.linalg.norm(columns, axis=0) + 1e-300
        moved = np.linalg.lstsq(columns / size, -self.left, rcond=None)[0] / size
        rest = other.left + np.hstack([other.slopes, held]) @ moved
        return float(np.sqrt(np.mean(rest**2)))

    def rows(self, which: np.ndarray) -> "Samples":
        """Some of the samples."""
        return Samples(self.left[which], self.slopes[which], self.motion[which])


def sides(drafts: Drafts) -> tuple[Samples, Samples]:
    """What is left and the motion, of the training and of the held-out logs."""
    both = drafts.ground.train, drafts.ground.heldout
    train, held = (Samples(s.residual, s.slopes, _motion(s, drafts.ranges)) for s in both)
    return train, held


def _motion(side: ground.Side, ranges: Ranges) -> np.ndarray:
    values = side.track.values(ranges)
    named = ("away", "line", "way", "pull", "late")
    return np.column_stack([side.thinned(np.asarray(values[n])) for n in named])


def by_sindy(train: Samples, held: Samples) -> tuple[float, int]:
    """Held-out RMSE and terms of sparse regression; its threshold by the last third of the rows."""
    pysindy: Any = import_module("pysindy")

    def library(motion: np.ndarray) -> np.ndarray:
        made = pysindy.PolynomialLibrary(degree=DEGREE).fit(motion)
        phases = [np.pi * k * motion[:, :1] for k in range(1, WAVES + 1)]
        waves = [f(phase) for phase in phases for f in (np.sin, np.cos)]
        turned = [w * motion[:, 2:3] for w in waves]
        return np.hstack([np.asarray(made.transform(motion)), *waves, *turned])

    def kept(side: Samples, threshold: float) -> np.ndarray:
        columns, target = library(side.motion), -side.left
        span = np.linalg.qr(side.slopes)[0]
        columns = columns - span @ (span.T @ columns)
        target = target - span @ (span.T @ target)
        columns = columns / (np.linalg.norm(columns, axis=0) + 1e-300)
        target = target / np.linalg.norm(target)
        found = pysindy.STLSQ(threshold=threshold, alpha=1e-6).fit(columns, target[:, None])
        return np.asarray(np.flatnonzero(np.abs(found.coef_).max(axis=0) > 0.0))

    early = np.arange(len(train.left)) < 2 * len(train.left) // 3
    first, last = train.rows(early), train.rows(~early)
    scores = {}
    for threshold in THRESHOLDS:
        terms = kept(first, threshold)
        whole = library(train.motion)[:, terms]
        scores[threshold] = first.after(last, whole[early], whole[~early])
    terms = kept(train, min(scores, key=lambda t: scores[t]))
    error = train.after(held, library(train.motion)[:, terms], library(held.motion)[:, terms])
    return error, len(terms)


def by_symbols(train: Samples, held: Samples, seed: int) -> tuple[float, int]:
    """Held-out RMSE and places where a signal stands, of a formula found by evolution."""
    operon: Any = import_module("pyoperon.sklearn")
    rows = np.linspace(0, len(train.left) - 1, min(ROWS, len(train.left))).astype(int)
    size = float(np.std(train.left)) or 1.0
    found = operon.SymbolicRegressor(
        allowed_symbols=SYMBOLS,
        optimizer_iterations=5,
        max_length=40,
        max_time=SECONDS,
        generations=10_000,
        max_evaluations=100_000_000,
        random_state=seed,
    ).fit(train.motion[rows], -train.left[rows] / size)
    own, other = (np.nan_to_num(found.predict(s.motion)).reshape(-1, 1) for s in (train, held))
    return train.after(held, own, other), len(
        re.findall(r"X\d", found.get_model_string(found.model_))
    )


def compared(case: Case) -> dict[str, Any]:
    """Held-out errors over the effort's RMS, and terms: of our law, PySINDy's and the formula."""
    made = drawn(case)
    with tempfile.TemporaryDirectory(prefix="spirob-laws-") as name:
        folder = Path(name)
        for file, text in made.files.items():
            (folder / file).write_text(text)
        search, bare = based(made, [*made.train, made.test], folder)
        found = search.run()
        law = composed(search, found, found.rungs[0])
        drafts = Drafts(ground.ground_of(search, list(bare.fit.estimates), bare.fit.changes))
    train, held = sides(drafts)
    size = float(np.sqrt(np.mean(search.models.heldout.measured() ** 2)))
    said = float(np.sqrt(found.chosen.heldout_square))
    ours = said if law is None else law.document["rmse"]["test"]
    sindy, symbols = by_sindy(train, held), by_symbols(train, held, case.seed)
    return {
        "simulator": case.simulator,
        "kind": case.kind,
        "seed": case.seed,
        "seen": made.truth["can_be_shown"],
        "bare": float(np.sqrt(bare.heldout_square)) / size,
        "composed": law is not None,
        "ours": [ours / size, 0 if law is None else len(law.document["terms"])],
        "sindy": [sindy[0] / size, sindy[1]],
        "symbols": [symbols[0] / size, symbols[1]],
    }


def cases(seeds: Sequence[int]) -> Iterator[Case]:
    """Every kind outside of the library on every simulator that plays it."""
    for seed in seeds:
        for name, simulator in SIMULATORS.items():
            for kind in OUTSIDE:
                if kind in simulator.kinds:
                    yield Case(name, kind, seed)


def main(arguments: list[str] | None = None) -> None:
    """Play the cases that the file does not hold yet, a line for each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, nargs="+", required=True)
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.jsonl")
    given = parser.parse_args(arguments)
    held = given.out.read_text().splitlines() if given.out.exists() else []
    known = {(r["simulator"], r["kind"], r["seed"]) for r in map(json.loads, held)}
    for case in cases(given.seeds):
        if (case.simulator, case.kind, case.seed) not in known:
            found = compared(case)
            with given.out.open("a") as file:
                file.write(json.dumps(found) + "\n")
            errors = (f"{who} {found[who][0]:.3f}" for who in ("ours", "sindy", "symbols"))
            print(f"{case.name}: {', '.join(errors)}", flush=True)


if __name__ == "__main__":
    main()
