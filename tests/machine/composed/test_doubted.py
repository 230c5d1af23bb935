"""A log that no model fits is no stranger where a law fits it that the others taught."""

import numpy as np
import pytest

from spirob.machine.axis import diagnose_recordings
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.judging import ALL_FIT
from tests.machine.rigs import description

RATE, NOISE = 200.0, 0.01


def log(middle, half, seed, turned=1.0, least=0.5):
    """An axis whose viscous friction grows towards its ends."""
    rng, t = np.random.default_rng(seed), np.arange(0, 12, 1 / RATE)
    q = middle + half * (0.8 * np.sin((1.1 + 0.2 * seed) * t) + 0.2 * np.sin(5.3 * t + seed))
    v, a = np.gradient(q, t), np.gradient(np.gradient(q, t), t)
    effort = turned * (0.004 * a + (least + 0.3 * q**2) * v) + NOISE * rng.normal(size=len(t))
    return {"t": t, "q": q, "u": effort}


def said(folder, turned, least=0.5):
    rig = RigFile.model_validate(description(criteria={"most": 2}))  # no name says what a law does
    about = {(0.0, 3.0, 1): 1.0, (0.0, 3.0, 2): 1.0, (0.3, 1.0, 3): turned}
    logs = [log(*how, way, least) for how, way in about.items()]
    read = [prepare(f"log{k}", one, rig) for k, one in enumerate(logs)]
    return diagnose_recordings(rig, folder, read[:-1], read[-1:]).document


def test_a_law_with_which_all_logs_fit_takes_the_doubt(tmp_path):
    found = said(tmp_path, 1.0)
    assert (found["verdict"], found["doubts"], found["effects"]) == ("unknown", [], [])
    assert found["explanation"].endswith(ALL_FIT)
    assert found["composed"]["terms"][0].startswith("line × ")


@pytest.mark.parametrize("least", [0.5, 0.0])
def test_a_log_of_a_turned_sign_stays_in_doubt(tmp_path, least):
    """Also where no model of the library fits the others, and the law alone tells it."""
    found = said(tmp_path, -1.0, least)
    assert found["doubts"]
    assert found["composed"] is None
