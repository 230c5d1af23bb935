"""What a feature is: one number of a wrap, with a name, a unit and a meaning."""

from collections.abc import Callable
from dataclasses import dataclass

from spirob.perceive.wrap import Wrap


@dataclass(frozen=True)
class Feature:
    """A documented number of one wrap.

    kind  temporal, spectral or electromechanical;  measure  computes it
    """

    name: str
    kind: str
    unit: str
    meaning: str
    measure: Callable[[Wrap], float]


FEATURES: dict[str, Feature] = {}


def feature(unit: str) -> Callable[[Callable[[Wrap], float]], Callable[[Wrap], float]]:
    """Enter a function of a `Wrap` in `FEATURES` under its own name; its docstring is its meaning.

    Its kind is the name of the file it stands in.
    """

    def enter(measure: Callable[[Wrap], float]) -> Callable[[Wrap], float]:
        name, meaning = measure.__name__, (measure.__doc__ or "").strip()
        if not meaning or name in FEATURES:
            raise TypeError(f"feature '{name}' needs a docstring and a name of its own")
        kind = measure.__module__.rpartition(".")[2]
        FEATURES[name] = Feature(name, kind, unit, meaning, measure)
        return measure

    return enter
