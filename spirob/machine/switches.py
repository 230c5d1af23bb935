"""What any combination of a rig's first candidates leaves: the switches of its page."""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from spirob.diagnosis.atlas import masks_of
from spirob.effects import Effect
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import Model
from spirob.machine.search import Found, Search

MOST = 3  # effects: seven combinations, of which the search has fitted most


def switches(search: Search, found: Found, ranked: Sequence[str]) -> list[dict[str, Any]]:
    """Every combination of the chosen effects and the next of `ranked`, fewer effects first.

    Each is fitted in full beside what the model holds.

    effects  names;  how  "base", "verdict" (the chosen set) or "refitted"
    rmse     RMS error by role;  regimes  the same by regime, over both roles; unit of the effort
    """
    bare, chosen, known = found.rungs[0], found.chosen, search.models.tried
    singles = [m for m in known.values() if len(m.names - bare.names) == 1 and bare.names < m.names]
    alone = {next(iter(m.names - bare.names)): m for m in singles}
    rest = [n for n in ranked if n in alone and n not in chosen.names]
    names = [*(n for n in ranked if n in alone and n in chosen.names), *rest][:MOST]
    made = [_entry(search, (), "base", bare.fit.changes)]
    for count in range(1, len(names) + 1):
        for subset in combinations(names, count):
            if bare.names | set(subset) == chosen.names:
                made.append(_entry(search, subset, "verdict", chosen.fit.changes))
                continue
            best = min((alone[n] for n in subset), key=lambda m: m.mean_square)
            effects = [*bare.effects, *(_of(alone[n], n) for n in subset)]
            start = {k: v for n in subset for k, v in alone[n].fit.changes.items()}
            model = search.models.fitted(tuple(effects), start | best.fit.changes)
            made.append(_entry(search, subset, "refitted", model.fit.changes))
    return made


def _of(model: Model, name: str) -> type[Effect]:
    return next(e for e in model.effects if e.name() == name)


def _entry(
    search: Search, effects: Sequence[str], how: str, changes: Mapping[str, float]
) -> dict[str, Any]:
    left = {"train": search.train(changes), "test": search.heldout(changes)}
    return {
        "effects": list(effects),
        "how": how,
        "rmse": {role: _rms(values) for role, values in left.items()},
        "regimes": _by_regime(search, left),
    }


def _by_regime(search: Search, left: Mapping[str, np.ndarray]) -> dict[str, float]:
    inside: dict[str, list[np.ndarray]] = {}
    for role, problem in (("train", search.train), ("test", search.heldout)):
        for piece, values in _pieces(problem, left[role]):
            for name, mask in masks_of(piece).items():
                inside.setdefault(name, []).append(values[mask])
    joined = {name: np.concatenate(parts) for name, parts in inside.items()}
    return {name: _rms(values) for name, values in joined.items() if len(values)}


def _pieces(problem: InverseProblem, left: np.ndarray) -> list[tuple[Any, np.ndarray]]:
    pieces = problem.stretches()
    edges = np.cumsum([0, *(len(p.seconds) for p in pieces)])
    return [(p, left[a:b]) for p, a, b in zip(pieces, edges, edges[1:], strict=False)]


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))
