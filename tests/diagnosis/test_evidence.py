"""What fitted trials say of new ones."""

import numpy as np
import pytest

from spirob.diagnosis.criteria import foreseen


def test_fitted_errors_are_raised_to_those_of_new_trials():
    rng = np.random.default_rng(1)
    n, p = 60, 12
    fitted, new = [], []
    for _ in range(400):
        regressors, noise, later = rng.normal(size=(n, p)), rng.normal(size=n), rng.normal(size=n)
        basis, _ = np.linalg.qr(regressors)
        taken = basis @ (basis.T @ noise)
        fitted.append(np.mean((noise - taken) ** 2))
        new.append(np.mean((later - taken) ** 2))  # the same regressors, another noise
    expected = foreseen(np.array(fitted), p, n).mean()
    assert expected == pytest.approx(np.mean(new), rel=0.02)
    assert expected > 1.4 * np.mean(fitted)


def test_without_fitted_numbers_nothing_is_raised():
    errors = np.array([1.0, 2.0])
    assert foreseen(errors, 0, 100) == pytest.approx(errors)
