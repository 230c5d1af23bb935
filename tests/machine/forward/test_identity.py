"""Forward after inverse is the identity: the effort that is asked for gives the motion."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.effects import all_effects
from spirob.machine.description.rig import RigFile
from spirob.machine.forward import Forward
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.laws import for_axis
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.preparation import applicable
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
BASE = {"rig.inertia": 0.05, "rig.viscous": 0.2}
RIG = RigFile.model_validate(
    description(effort={"column": "u", "unit": "N·m", "kind": "torque", "origin": "command"})
)
POSSIBLE, _ = applicable(for_axis(all_effects().values()), RIG, False, 0.0, True)
# position within these [rad], of ±1.3: the steps' own error; a torque that depends on the
# acceleration takes it from the step before; a shaft takes it from three speeds in a row
SMOOTH, TRAILING, ELASTIC = 5e-5, 1.5e-3, 8e-3
LIMITS = dict.fromkeys(("direction_dependent_efficiency", "load_dependent_friction"), TRAILING)
LIMITS |= {"coulomb_friction": 3e-4, "stribeck_friction": TRAILING, "presliding_friction": 5e-4}
LIMITS |= {"driver_dead_band": 5e-4, "winding_heating": TRAILING}
LIMITS |= {"backlash": ELASTIC, "gear_compliance": ELASTIC}


def asked_for(changes, rig=RIG, effects=POSSIBLE):
    """A smooth motion of ten seconds whose logged effort is the one that the model asks for."""
    t, w = np.arange(0, 10, 1e-3), 2 * np.pi * 0.6
    q = np.sin(w * t) + 0.3 * np.sin(2.7 * w * t)
    log = prepare("log", {"t": t, "q": q, "u": np.cos(w * t)}, rig)
    made = InverseProblem(rig, None, [log], effects, SIZES, 0.02)
    motion, p = made.asked.motion, made.table.vector(changes)
    effort = made.asked.effort(p)
    for _ in range(10):  # a frame that is late holds the measured effort of another time
        made.asked.motion = replace(motion, effort=effort)
        effort = made.asked.effort(p)
    made.asked.motion = replace(motion, effort=effort)
    return made


def missed(made, changes):
    """RMS error of position over half seconds and over the whole log."""
    forward = Forward(made)
    found = forward.errors(changes, forward.predicted(changes))
    return [found[span]["position"]["rmse"] for span in ("window", "whole")]


@pytest.mark.parametrize("effect", POSSIBLE, ids=lambda e: e.name())
def test_the_effort_that_is_asked_for_gives_the_motion(effect):
    made = asked_for({})
    numbers = {f"{effect.name()}.{n}" for n in effect.parameters()}
    changes = BASE | {n: made.table.about[n].nominal for n in numbers}
    limit = LIMITS.get(effect.name(), SMOOTH)
    for found in missed(asked_for(changes), changes):
        assert found < limit


def test_a_log_whose_effort_trails_is_played_at_its_time():
    late = BASE | {"rig.delay": 3.3e-3}
    assert missed(asked_for(late), late)[1] < 2 * SMOOTH
    assert missed(asked_for(late), BASE)[1] > 10 * SMOOTH


def test_a_report_that_lags_is_played_as_it_was():
    """Of 20 ms nothing is left; played as reported they are 0.15 of ±1.3 rad."""
    rig, effects = RigFile.model_validate(description()), [all_effects()["current_lag"]]
    lag = BASE | {"current_lag.time": 0.02}
    assert missed(asked_for(lag, rig, effects), lag)[1] < 10 * SMOOTH
    assert missed(asked_for(lag, rig, effects), BASE)[1] > 100 * SMOOTH
