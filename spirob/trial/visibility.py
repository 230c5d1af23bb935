"""Measures how strongly each hidden kind shows, for the table in `trial/strength.py`.

    python -m spirob.trial.visibility --seeds 917 918 919 [--kinds KIND ...] [--jobs N]

Each robot plays the trial's bends, the model's numbers are fitted without any effect, and of the
held-out error what is left with nothing hidden is taken off.  Kinds that are not linear in their
strength are measured near the error that the trial draws: once, and again at the strength which
that measurement asks for.  What is printed is % of the effort at strength 1.
"""

import argparse
from collections.abc import Mapping, Sequence

import numpy as np
from joblib import Parallel, delayed

from spirob.diagnosis.ladder import begun
from spirob.diagnosis.rungs import Rung, Settings
from spirob.emulator.rig import HiddenSettings
from spirob.ending import end_with_parent
from spirob.identify.numbers import FITTED
from spirob.identify.problem import Problem, effort_rms
from spirob.plant import Plant, Rig
from spirob.trial.played import problems_of, recorded
from spirob.trial.strength import VISIBLE, adjusted, beside, sizes, strength_of


def left(base: Rung, problems: Mapping[str, Problem]) -> float:
    """RMSE of the fitted model without any effect, in % of the effort's RMS.

    On trials that were not fitted, those that decide and those that are reported.
    """
    shares = [
        (base.scores[role].rmse / effort_rms(problems[role])) ** 2
        for role in ("validate", "heldout")
    ]
    return 100.0 * float(np.sqrt(np.mean(shares)))


def shown_by(hidden: HiddenSettings, seed: int) -> float:
    """The same of one robot, recorded and fitted for this."""
    problems = problems_of(recorded(hidden, seed), Plant(Rig(), []))
    return left(begun(problems, FITTED, {}, Settings(intervals=False)).base, problems)


def nothing(seed: int) -> float:
    """The same of a robot with nothing hidden."""
    return shown_by(HiddenSettings("none"), seed)


def visible(kind: str, seed: int, plain: float) -> tuple[str, int, list[float], list[float]]:
    """Strengths tried in one robot, and what each shows per strength [% of the effort].

    plain  what is left in the same robot with nothing hidden
    """
    wanted = float(np.mean(sizes()))
    strength = strength_of(kind, wanted)
    tries: list[tuple[float, float]] = []
    for _ in range(2):
        shown = beside(shown_by(HiddenSettings(f"{kind}:{strength:.6g}"), seed), plain)
        tries.append((strength, shown))
        strength = adjusted(tries, wanted)
    return kind, seed, [s for s, _ in tries], [shown / s for s, shown in tries]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table, kind by kind."""
    parser = argparse.ArgumentParser(description="how strongly each hidden kind shows")
    parser.add_argument("--seeds", type=int, nargs="+", required=True)
    parser.add_argument("--kinds", nargs="+", default=sorted(VISIBLE), choices=sorted(VISIBLE))
    parser.add_argument("--jobs", type=int, default=-1)
    given = parser.parse_args(arguments)
    run = Parallel(given.jobs, return_as="generator", initializer=end_with_parent)
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
