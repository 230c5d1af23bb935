"""What a diagnosis keeps for an export: covariance, effects that are there, held-out rows."""

import numpy as np
import pytest

from spirob.identify.fit import fit
from spirob.identify.intervals import covariance_of
from tests.export.machines import exported_model, numbers_of, problem_of

ROBUST = 100.0


@pytest.fixture(scope="module")
def fitted(tmp_path_factory):
    """A fit of four numbers, one of them over decades, to the law with noise."""
    names = ["coulomb_friction", "presliding_friction"]
    problem = problem_of(tmp_path_factory.mktemp("fit"), names, seconds=4.0)
    start = numbers_of(problem, names)
    truth = problem(start | {"rig.viscous": 0.05}) + problem.measured()
    problem._measured = truth + 0.01 * np.random.default_rng(0).normal(size=len(truth))
    asked = ["rig.viscous", *(n for n in start if not n.endswith("softness"))]
    return problem, fit(problem, asked, start, ROBUST, 40, steps=(1e-3,), exact=False, smooth=True)


def test_covariance_is_that_of_the_intervals(fitted):
    problem, found = fitted
    covariance = np.array(covariance_of(problem, found, ROBUST))
    assert covariance == pytest.approx(covariance.T)
    assert np.all(
        np.linalg.eigvalsh(covariance / np.sqrt(np.outer(*[np.diag(covariance)] * 2))) > 0
    )
    for k, (name, one) in enumerate(found.estimates.items()):
        sigma = np.sqrt(covariance[k, k])
        if problem.table.about[name].log:  # its interval is that of the logarithm
            ratio = np.log(one.high / one.low) / 3.92
            assert sigma == pytest.approx(one.value * ratio, rel=1e-6)
        elif not one.at_bound and one.low > problem.table.about[name].low:
            assert sigma == pytest.approx((one.high - one.low) / 3.92, rel=1e-6)


def test_an_effect_that_is_absent_does_not_go_along(tmp_path):
    model = exported_model(tmp_path, ["coulomb_friction"], seconds=1.5, zero=("coulomb_friction",))
    assert model.effects == ()


def test_of_a_body_its_load_is_kept(tmp_path):
    exported_model(tmp_path, ["mount_tilt"], True, seconds=1.5)
    from spirob.export.corrected import corrected, read_document
    from spirob.export.heldout import Heldout

    table = Heldout(corrected(read_document(tmp_path / "diagnosis.json"), tmp_path)).table
    # no gravity in the plane: what it carries is its inertia, spring and damping
    moment = 0.01 + 0.3 * 0.2**2
    wanted = moment * table["acceleration"] + 0.4 * table["position"] + 0.01 * table["speed"]
    assert np.allclose(table["carried"], wanted, atol=1e-9 * np.abs(wanted).max())
