"""Folds that hold whole diameters out, so that no size is judged by a model that has seen it."""

import numpy as np

from spirob.errors import DataError


def folds(diameters: np.ndarray, count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Train and test rows of at most `count` folds that hold whole diameters out.

    Raises DataError with fewer than three diameters.
    """
    from sklearn.model_selection import GroupKFold

    groups = len(np.unique(diameters))
    if groups < 3:
        raise DataError(f"training a size model needs at least 3 diameters, the table has {groups}")
    splitter = GroupKFold(min(count, groups))
    return list(splitter.split(diameters[:, None], groups=np.rint(1e6 * diameters).astype(int)))
