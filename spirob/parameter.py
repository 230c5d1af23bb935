"""Bounded numbers: each has a nominal value, bounds, a unit, a symbol, a meaning and a source.

A class that inherits `Numbers` declares them one to a line with `bounded(...)`; instances hold
values.  A `Table` lines up the numbers of several owners as one vector, named `owner.field`, for
the compiled loop and for the optimiser.
"""

import dataclasses
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from spirob.errors import ConfigError

ROUND = 0.9  # of the drum's turns: a short stroke tells an order to a tenth
WIDE = 100.0  # ratio of bounds that span decades


@dataclass(frozen=True)
class Parameter:
    """What is known of one number before any measurement.

    log    true where the number spans decades: the optimiser then moves its logarithm
    times  name of another number; as a load this one acts in proportion to it, a damping time
           to the stiffness that it belongs to
    tolerance  relative, of a number that the data sheet gives: a fit keeps it that near to its
           value, beyond it an effect is missing; 0 where the bounds are all that is known
    geared  true where the number counts periods in a turn of the rotor, of anything that the rotor
           turns: with a gear of ratio G nothing comes round less often than 1/G
    """

    nominal: float
    low: float
    high: float
    unit: str
    symbol: str
    meaning: str
    source: str = ""
    log: bool = False
    times: str = ""
    tolerance: float = 0.0
    geared: bool = False

    def behind(self, gear_ratio: float) -> "Parameter":
        """The same behind a gear of this ratio G, which bounds from below what is `geared`."""
        if not self.geared:
            return self
        return dataclasses.replace(self, low=max(self.low, ROUND / gear_ratio))

    def reach(self, value: float) -> tuple[float, float]:
        """Between what a fit may move the number from `value`."""
        if self.tolerance == 0.0:
            return self.low, self.high
        margin = self.tolerance * abs(value)
        return max(self.low, value - margin), min(self.high, value + margin)

    def at_bound(self, found: float, value: float) -> bool:
        """Whether a fit that began at `value` found an end of its reach."""
        least, most = self.reach(value)
        near = 1e-3 * (most - least)
        # on wide bounds a thousandth of the span may be many times the lower one
        if self.log or most > WIDE * least > 0.0:
            return found <= 1.005 * least or found >= 0.995 * most
        return found <= least + near or found >= most - near

    def __post_init__(self) -> None:
        if not self.low <= self.nominal <= self.high:
            raise ConfigError(
                f"parameter '{self.symbol}': nominal {self.nominal} is outside "
                f"[{self.low}, {self.high}]"
            )
        if self.log and self.low <= 0:
            raise ConfigError(f"parameter '{self.symbol}': log scale needs a lower bound above 0")


def bounded(
    nominal: float,
    low: float,
    high: float,
    unit: str,
    symbol: str,
    meaning: str,
    source: str = "",
    log: bool = False,
    times: str = "",
    tolerance: float = 0.0,
    geared: bool = False,
) -> Any:
    """Declare one bounded number as a field of a `Numbers` class."""
    known = (nominal, low, high, unit, symbol, meaning, source, log, times, tolerance, geared)
    about = Parameter(*known)
    return dataclasses.field(default=nominal, metadata={"parameter": about})


def _number(name: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise ConfigError(f"{name}: a number is needed, got {str(value)[:40]!r}") from None


class Numbers:
    """Base of every class that declares bounded numbers; subclasses become frozen dataclasses.

    Raises ConfigError when a value is not finite or lies outside its bounds.
    """

    owner: ClassVar[str] = ""

    if TYPE_CHECKING:  # the declared fields by name, all with defaults; not expressible otherwise

        def __init__(self, **values: float) -> None: ...

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        dataclasses.dataclass(frozen=True, kw_only=True)(cls)

    def __post_init__(self) -> None:
        for name, about in self.parameters().items():
            value = getattr(self, name)
            if not (np.isfinite(value) and about.low <= value <= about.high):
                raise ConfigError(
                    f"{self.owner or type(self).__name__}.{name} = {value} {about.unit} is out of "
                    f"range [{about.low}, {about.high}] ({about.meaning})"
                )

    @classmethod
    def parameters(cls) -> dict[str, Parameter]:
        """The declared numbers by field name, in order of declaration."""
        fields = dataclasses.fields(cls)  # type: ignore[arg-type]
        return {f.name: f.metadata["parameter"] for f in fields if "parameter" in f.metadata}

    @classmethod
    def from_mapping(cls, values: Mapping[str, float]) -> "Numbers":
        """Build from a mapping; an unknown key is an error that lists the known ones."""
        known = cls.parameters()
        for key in values:
            if key not in known:
                raise ConfigError(
                    f"{cls.owner or cls.__name__} has no number '{key}'; it has: {', '.join(known)}"
                )
        return cls(**{key: _number(f"{cls.owner}.{key}", value) for key, value in values.items()})


class Table:
    """Names and values of many bounded numbers as one vector, in a fixed order."""

    def __init__(self, owners: Iterable[tuple[str, Numbers]]):
        self.about: dict[str, Parameter] = {}
        values: list[float] = []
        for owner, numbers in owners:
            for field, about in numbers.parameters().items():
                self.about[f"{owner}.{field}"] = about
                values.append(float(getattr(numbers, field)))
        self._line_up(values)

    @classmethod
    def of(cls, about: Mapping[str, Parameter], values: Mapping[str, float]) -> "Table":
        """A table of numbers that no class declares; `values` where they are not nominal."""
        table = cls([])
        table.about = dict(about)
        table._line_up([values.get(name, number.nominal) for name, number in about.items()])
        return table

    def joined(self, about: Mapping[str, Parameter]) -> "Table":
        """This table with further numbers at its end, at their nominal values."""
        values = dict(zip(self.names, self.values.tolist(), strict=True))
        return Table.of({**self.about, **about}, values)

    def within(self, about: Mapping[str, Parameter]) -> "Table":
        """This table with something else known of some numbers, which stand at nominal then."""
        values = dict(zip(self.names, self.values.tolist(), strict=True))
        values |= {name: number.nominal for name, number in about.items()}
        return Table.of({**self.about, **about}, values)

    def narrowed(self, about: Mapping[str, Parameter]) -> "Table":
        """This table with other bounds of some numbers, which keep their values."""
        values = dict(zip(self.names, self.values.tolist(), strict=True))
        for name, number in about.items():
            if not number.low <= values[name] <= number.high:
                raise ConfigError(
                    f"{name} = {values[name]:g} {number.unit} is out of range [{number.low:.3g}, "
                    f"{number.high:.3g}] of this arm ({number.meaning})"
                )
        return Table.of({**self.about, **about}, values)

    def behind(self, gear_ratio: float) -> "Table":
        """This table for a machine with a gear of this ratio."""
        values = dict(zip(self.names, self.values.tolist(), strict=True))
        return Table.of({n: p.behind(gear_ratio) for n, p in self.about.items()}, values)

    def _line_up(self, values: list[float]) -> None:
        self.names = list(self.about)
        self.index = {name: k for k, name in enumerate(self.names)}
        self.values = np.array(values, dtype=float)

    def vector(self, changes: Mapping[str, float] | None = None) -> np.ndarray:
        """The whole vector with some values replaced; raises ConfigError on an unknown name."""
        out = self.values.copy()
        for name, value in (changes or {}).items():
            out[self.position(name)] = value
        return out

    def position(self, name: str) -> int:
        """Index of a parameter in the vector; raises ConfigError on an unknown name."""
        if name not in self.index:
            raise ConfigError(f"no parameter '{name}'; known: {', '.join(self.names)}")
        return self.index[name]

    def bounds(self, names: Iterable[str]) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of the named parameters."""
        chosen = [self.about[self.names[self.position(n)]] for n in names]
        return np.array([p.low for p in chosen]), np.array([p.high for p in chosen])
