"""How long the rest will take: from what each unit took before, else from the units done so far."""

from collections.abc import Mapping, Sequence


class TimeLeft:
    """Expected remaining time of a list of units that are done in order.

    units     names in order;  expected  seconds that a unit took last time, where known
    """

    def __init__(self, units: Sequence[str], expected: Mapping[str, float] | None = None):
        self._left = list(units)
        self._expected = dict(expected or {})
        self._taken: list[float] = []

    def done(self, unit: str, seconds: float, worked: bool = True) -> None:
        """A unit is over; one that had nothing to do says nothing about the others."""
        if unit in self._left:
            self._left.remove(unit)
        if worked:
            self._taken.append(seconds)

    def seconds(self, in_current: float = 0.0) -> float | None:
        """Seconds to the end, `in_current` of them being spent; None while nothing tells."""
        mean = sum(self._taken) / len(self._taken) if self._taken else None
        parts = [self._expected.get(unit, mean) for unit in self._left]
        known = [part for part in parts if part is not None]
        if len(known) < len(parts):
            return None
        first = max(0.0, known[0] - in_current) if known else 0.0
        return first + sum(known[1:])


def clock(seconds: float | None) -> str:
    """Minutes and seconds, as 4:07; a dash where it is not known."""
    if seconds is None:
        return "–:––"
    whole = round(seconds)
    return f"{whole // 60}:{whole % 60:02d}"
