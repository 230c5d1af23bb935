"""Measures how strongly each hidden kind shows, for the table in `trial/strength.py`.

    python -m spirob.trial.visibility --seeds 917 918 919 [--kinds KIND ...] [--jobs N]

Each robot plays the trial's bends, the model's numbers are fitted without any effect, and of the
held-out error what is left with nothing hidden is taken off.  Kinds that are not linear in their
strength are measured near the error that the trial draws: once, and again at the strength which
that measurement asks for.  What is printed is % of the effort at strength 1.
"""

import argparse
from collections.abc import Sequence

import numpy as np
from joblib import Parallel, delayed

from spirob.diagnose.rungs import Settings
from spirob.emulator.rig import HiddenSettings
from spirob.identify.fit import STEPS, fit
from spirob.identify.measurement import Measurement
from spirob.identify.numbers import FITTED
from spirob.identify.problem import effort_rms
from spirob.plant import Plant, Rig
from spirob.trial.played import problems_of, recorded
from spirob.trial.strength import SIZES, VISIBLE, adjusted, beside, strength_of


def left(trials: dict[str, list[Measurement]]) -> float:
    """RMSE of the fitted model without any effect, in % of the effort's RMS.

    On trials that were not fitted, those that decide and those that are reported.
    """
    problems = problems_of(trials, Plant(Rig(), []))
    settings = Settings()
    steps, patience = STEPS[:1], settings.patience
    found = fit(problems["train"], FITTED, {}, settings.scale, patience, steps=steps, exact=False)
    shares = []
    for problem in (problems["validate"], problems["heldout"]):
        errors = problem(found.changes)[problem.rows]
        shares.append(float(np.mean(errors**2)) / effort_rms(problem) ** 2)
    return 100.0 * float(np.sqrt(np.mean(shares)))


def nothing(seed: int) -> float:
    """The same of a robot with nothing hidden."""
    return left(recorded(HiddenSettings("none"), seed))


def visible(kind: str, seed: int, plain: float) -> tuple[str, int, list[float], list[float]]:
    """Strengths tried in one robot, and what each shows per strength [% of the effort].

    plain  what is left in the same robot with nothing hidden
    """
    wanted = float(np.mean(SIZES))
    strength = strength_of(kind, wanted)
    strengths, sizes = [], []
    for _ in range(2):
        trials = recorded(HiddenSettings(f"{kind}:{strength:.6g}"), seed)
        strengths.append(strength)
        sizes.append(beside(left(trials), plain))
        strength = adjusted(strength, sizes[-1], wanted)
    return kind, seed, strengths, [e / s for e, s in zip(sizes, strengths, strict=True)]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table, kind by kind."""
    parser = argparse.ArgumentParser(description="how strongly each hidden kind shows")
    parser.add_argument("--seeds", type=int, nargs="+", required=True)
    parser.add_argument("--kinds", nargs="+", default=sorted(VISIBLE), choices=sorted(VISIBLE))
    parser.add_argument("--jobs", type=int, default=-1)
    given = parser.parse_args(arguments)
    run = Parallel(given.jobs, return_as="generator")
    plain = dict(zip(given.seeds, run(delayed(nothing)(s) for s in given.seeds), strict=True))
    print(f"nothing hidden leaves {plain}", flush=True)
    jobs = [delayed(visible)(k, s, plain[s]) for k in given.kinds for s in given.seeds]
    found: dict[str, list[float]] = {}
    for kind, seed, strengths, shown in run(jobs):
        found.setdefault(kind, []).append(shown[-1])
        print(f"{kind} {seed}: {np.round(strengths, 3)} shows {np.round(shown, 3)}", flush=True)
    for kind, values in found.items():
        middle = float(np.exp(np.mean(np.log(np.maximum(values, 1e-3)))))
        print(f'    "{kind}": {middle:.3g},')


if __name__ == "__main__":
    main()
