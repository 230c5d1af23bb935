"""Numbers that fail where nobody foresaw it, told in a sentence."""

import re
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from spirob.errors import DataError

# what SciPy and scikit-learn say of numbers that they cannot use; any other ValueError is a bug
SAID = re.compile(r"finite|\bnan|\binf|too large|bound|infeasible|converge", re.IGNORECASE)


@contextmanager
def failures_told(who: str) -> Iterator[None]:
    """Inside, a numerical failure becomes a DataError that names `who`."""
    try:
        yield
    except (np.linalg.LinAlgError, ArithmeticError, MemoryError) as error:
        raise DataError(_sentence(who, error)) from error
    except ValueError as error:
        if not SAID.search(str(error)):
            raise
        raise DataError(_sentence(who, error)) from error


def _sentence(who: str, error: Exception) -> str:
    said = " ".join(str(error).split())[:200].rstrip(".") or type(error).__name__
    return (
        f"{who}: its numbers cannot be computed with ({said}); look for a factor, a bound or a "
        "value in the logs that is many times too large or too small"
    )
