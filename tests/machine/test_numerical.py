"""Numbers that fail are told; a bug of ours keeps its traceback."""

import numpy as np
import pandas as pd
import pytest
from scipy.linalg import solve
from scipy.optimize import least_squares

import spirob
from spirob.errors import DataError, SimulationError
from spirob.machine.diagnosis import failures_told
from tests.machine.rigs import damper


def diverged():
    raise SimulationError("the model became non-finite after 1.577 s")


FAILING = {
    "singular": lambda: np.linalg.inv(np.zeros((2, 2))),
    "overflow": lambda: 1e308**2,
    "divided": lambda: 1.0 / 0.0,
    "bounds": lambda: least_squares(lambda x: x, [1.0], bounds=([1.0], [1.0])),
    "outside": lambda: least_squares(lambda x: x, [3.0], bounds=([1.0], [2.0])),
    "residual": lambda: least_squares(lambda x: x * np.nan, [1.0]),
    "not finite": lambda: solve(np.full((2, 2), np.nan), np.ones(2)),
    "simulation": lambda: diverged(),
    "memory": lambda: np.zeros((10**7, 10**7)),
}
BUGS = {
    "key": lambda: {}["absent"],
    "type": lambda: "a" + 1,
    "attribute": lambda: None.absent,
    "shapes": lambda: np.ones(2) + np.ones(3),
    "unpacking": lambda: (lambda a, b: a)(*[1]),
}


@pytest.mark.parametrize("kind", FAILING)
def test_a_numerical_failure_is_a_sentence(kind):
    sentence = r"rig\.yaml: its numbers cannot be computed with"
    with pytest.raises(DataError, match=sentence), failures_told("rig.yaml"):
        FAILING[kind]()


@pytest.mark.parametrize("kind", BUGS)
def test_a_bug_stays_one(kind):
    ours = (KeyError, TypeError, AttributeError, ValueError)
    with pytest.raises(ours), failures_told("rig.yaml"):
        BUGS[kind]()


@pytest.mark.parametrize("kind", [*FAILING, *BUGS])
def test_what_the_callers_progress_raises_comes_out_as_it_is(kind):
    case, raised = damper(1003), []

    def progress(text):
        try:
            (FAILING | BUGS)[kind]()
        except Exception as error:
            raised.append(error)
            raise

    logs = [pd.DataFrame(trial) for trial in case.train]
    with pytest.raises(Exception) as told:  # noqa: PT011 - any kind
        spirob.diagnose(case.rig, train=logs, progress=progress)
    assert told.value is raised[0]
    assert told.value.__cause__ is None
