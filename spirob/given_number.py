"""Which numbers may stand in a description of a machine."""

from typing import Annotated

from pydantic import AfterValidator

# Beyond these no quantity of a machine lies in any unit that the program reads, and below them the
# squares and ratios that a fit is made of stay far inside what a double can hold.
LEAST, MOST = 1e-15, 1e15


def sized(value: float) -> float:
    """The number itself; raises ValueError where it is too large or too small to be meant."""
    if value != 0.0 and not LEAST <= abs(value) <= MOST:
        raise ValueError(f"{value:g} is no size of a machine: 0, or {LEAST:g} to {MOST:g}")
    return value


Size = Annotated[float, AfterValidator(sized)]


def sized_not_zero(value: float) -> float:
    """As `sized`, for what may not vanish."""
    if value == 0.0:
        raise ValueError("0 would erase it")
    return sized(value)
