"""Which logs of the arm are fitted, which choose, and which are held out."""

from collections.abc import Sequence
from pathlib import Path

from spirob.errors import ConfigError

Log = Path | str


def roles(train: Sequence[Log], test: Sequence[Log]) -> dict[str, list[Log]]:
    """Logs by role; the last third of the training logs chooses between effects.

    A log of the arm is played from rest, so none can be divided.  Raises ConfigError where there
    are fewer than two training logs and one held out.
    """
    if len(train) < 2 or not test:
        raise ConfigError(
            "body: arm needs two logs in --train, one to fit and one to choose by, and one in "
            f"--test; got {len(train)} and {len(test)}"
        )
    cut = len(train) - max(1, len(train) // 3)
    return {"train": list(train[:cut]), "validate": list(train[cut:]), "heldout": list(test)}
