"""A machine is the same in any unit: a factor moves all numbers of a rig, and no answer."""

import numpy as np
import pytest

from spirob.errors import ConfigError
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.preparation import ready_of, search_of
from spirob.machine.search.wrong_numbers import in_scale
from tests.machine.rigs import description

INERTIA, VISCOUS, COULOMB = 1.0, 2.0, 3.0
TIME = np.arange(0, 8, 4e-3)
FIT = {
    "inertia": {"nominal": 0.8, "low": 0.1, "high": 10.0},
    "viscous": {"nominal": 1.0, "low": 0.0, "high": 20.0},
}


def ready(made=None, fit=FIT, known=None, **factors):
    """A rotor with dry friction whose description has its columns a factor off."""
    rig = description(fit=fit, known=known or {"delay": 0.0})
    for column, factor in factors.items():
        rig[column] = {**rig[column], "factor": factor}
    turn = np.random.default_rng(0).uniform(2.0, 9.0, 3)[:, None] * TIME + np.ones((3, 1))
    rate = np.diff(turn)[:, :1] / TIME[1]
    q, v = np.sin(turn).sum(0), (rate * np.cos(turn)).sum(0)
    a = -(rate**2 * np.sin(turn)).sum(0)
    if made is None:
        made = INERTIA * a + VISCOUS * v + COULOMB * np.tanh(v / 0.1)
    read = RigFile.model_validate(rig)
    logs = [prepare(name, {"t": TIME, "q": q, "u": made}, read) for name in ("log", "other")]
    return ready_of(read, None, logs[:1], logs[1:])


FACTORS = [
    {"effort": 1e-9},
    {"effort": 1e-3},
    {"effort": 1e3},
    {"effort": 1e9},
    {"position": 1e9},
    {"position": 1e-9},
    {"position": 1e3, "effort": 1e-6},
]


@pytest.mark.parametrize("factors", FACTORS)
def test_a_factor_moves_the_numbers_and_nothing_else(factors):
    times = factors.get("effort", 1.0) / factors.get("position", 1.0)
    search, _ = search_of(in_scale(ready(**factors)))
    dry = next(e for e in search.candidates if e.name() == "coulomb_friction")
    model = search.models.fitted((dry,), {})
    found = {name.partition(".")[2]: e.value for name, e in model.fit.estimates.items()}
    assert found["inertia"] == pytest.approx(times * INERTIA, rel=0.01)
    assert found["viscous"] == pytest.approx(times * VISCOUS, rel=0.05)
    size = factors.get("effort", 1.0) * COULOMB
    assert found["coulomb_torque"] == pytest.approx(size, rel=0.03)


@pytest.mark.parametrize("factors", FACTORS)
def test_a_factor_moves_the_scale_where_the_inertia_is_known(factors):
    """scale·e = J·a: a factor f of the effort, or 1/f of the motion, makes the scale 1/f."""
    times = factors.get("effort", 1.0) / factors.get("position", 1.0)
    fit = {"scale": {"nominal": 1.2, "low": 0.5, "high": 2.0}, "viscous": FIT["viscous"]}
    moved = in_scale(ready(fit=fit, known={"delay": 0.0, "inertia": INERTIA}, **factors))
    scale = moved.rig.fit["scale"]
    assert scale.nominal == pytest.approx(1.0 / times, rel=0.05)
    assert scale.low < 1.0 / times < scale.high
    asked = moved.sizes.torque / factors.get("position", 1.0)  # the size of the rig goes with it
    assert asked == pytest.approx(ready().sizes.torque, rel=0.05)


@pytest.mark.parametrize(
    "of",
    [
        {},
        {"made": np.random.default_rng(0).normal(size=len(TIME))},
        {"fit": {**FIT, "inertia": {"nominal": 0.3, "low": 0.1, "high": 0.5}}},
    ],
)
def test_bounds_stay_where_the_logs_do_not_tell_or_nearly_agree(of):
    begun = ready(**of)
    assert in_scale(begun).rig.fit == begun.rig.fit


def test_numbers_of_which_the_effort_shows_nothing_are_told_with_what_they_make():
    effort = 1e12 * np.random.default_rng(0).normal(size=len(TIME))
    with pytest.raises(ConfigError, match=r"inertia of 0.8 \S+ makes .* of an effort of \d"):
        search_of(ready(made=effort))
