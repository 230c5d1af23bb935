"""A mass of a model file is blamed where another makes the model fit, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.search import Search
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.body import RigidBody
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.models import Models
from spirob.machine.search.wrong_numbers import out_of_scale
from tests.machine.rigs import description

LEG = """<mujoco><option gravity="0 0 -9.81"/><worldbody>
<body name="thigh"><joint name="hip" axis="0 1 0"/><inertial pos="0 0 -0.15" mass="{thigh}"
diaginertia="{about_thigh} {about_thigh} 0.0001"/>
<body name="shin" pos="0 0 -0.3"><joint name="knee" axis="0 1 0"/><inertial pos="0 0 -0.1"
mass="{shin}" diaginertia="{about_shin} {about_shin} 0.0001"/></body></body></worldbody></mujoco>"""
SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
TIME = np.arange(0, 10, 5e-3)


def leg(folder, thigh=1.0, shin=0.8):
    """A leg with a thigh and a shin of so many kg, its inertias in proportion."""
    text = LEG.format(thigh=thigh, shin=shin, about_thigh=thigh / 100, about_shin=shin / 100)
    (folder / "leg.xml").write_text(text)
    joints = {"knee": {"column": "knee", "unit": "rad"}}
    rig = RigFile.model_validate(
        description(body={"mjcf": "leg.xml", "joint": "hip", "joints": joints})
    )
    return rig, RigidBody(rig.body, folder, True)


def search_of(folder, weight=0.0, **told):
    """A search over a log of the leg, by a model file that tells other masses.

    weight  of the effort, that no mass makes
    """
    hip, knee = np.sin(3 * TIME) + 0.3 * np.sin(7.1 * TIME), 0.8 * np.sin(4.7 * TIME + 1)
    columns = {"t": TIME, "q": hip, "knee": knee, "u": np.sin(TIME)}
    rig, body = leg(folder)
    (piece,) = prepare("log", columns, rig).pieces
    effort = body.load(piece) + 0.02 * piece.a + 0.05 * piece.v + 0.2 * np.tanh(piece.v / 0.02)
    columns["u"] = np.interp(TIME, piece.seconds, effort + weight * np.sin(40 * piece.q))
    rig, body = leg(folder, **told)
    problem = InverseProblem(rig, body, [prepare("log", columns, rig)], [], SIZES, 0.02)
    return Search(Models(problem, problem, ["rig.inertia", "rig.viscous"]), [], Criteria())


@pytest.mark.parametrize(
    ("told", "said"),
    [
        ({"shin": 8.0}, "With body 'shin' 0.1"),
        ({"shin": 0.08}, "With body 'shin' 10"),
        ({"thigh": 0.1}, "With body 'thigh' 10"),
        ({"thigh": 10.0, "shin": 8.0}, "The effort is 0.1"),
    ],
)
def test_a_mass_that_is_ten_times_off_is_told_with_both_figures(told, said, tmp_path):
    search = search_of(tmp_path, **told)
    model = search.models.fitted((), {})
    found = out_of_scale(search, model)
    begin, number = said.rsplit(" ", 1)
    assert found.startswith(begin)
    factor = found.removeprefix(begin).split()[0]
    assert float(factor) == pytest.approx(float(number), rel=0.01)
    assert "100% of the" in found
    assert "as described" in found
    fits = replace(model, left=1e-6 * model.left, heldout=1e-6 * model.heldout)
    assert out_of_scale(search, fits) == ""  # a law that fits as well


@pytest.mark.parametrize(("known", "factor"), [(1e3, 1e-3), (0.03, 33.3), (1.2, 0.0)])
def test_a_known_inertia_that_is_many_times_off_is_told(known, factor):
    motion = np.sin(3 * TIME) + 0.3 * np.sin(7.1 * TIME)
    speed = 3 * np.cos(3 * TIME) + 2.13 * np.cos(7.1 * TIME)
    effort = -9 * np.sin(3 * TIME) - 15.1 * np.sin(7.1 * TIME) + 0.5 * speed + np.sin(motion)
    rig = RigFile.model_validate(
        description(
            fit={"viscous": {"nominal": 1.0, "low": 0.0, "high": 9.0}}, known={"inertia": known}
        )
    )
    logs = [prepare("log", {"t": TIME, "q": motion, "u": effort}, rig)]
    problem = InverseProblem(rig, None, logs, [], SIZES, 0.02)
    search = Search(Models(problem, problem, ["rig.viscous"]), [], Criteria())
    found = out_of_scale(search, search.models.fitted((), {}))
    assert found.startswith("The effort is ") == (factor > 0.0)
    if found:
        told = found.removeprefix("The effort is ").split()[0]
        assert float(told) == pytest.approx(factor, rel=0.02)


@pytest.mark.parametrize(
    ("told", "weight"), [({}, 0.0), ({"shin": 1.2}, 0.0), ({"shin": 8.0}, 30.0), ({}, 5.0)]
)
def test_no_mass_is_blamed_that_is_near_or_makes_nothing_fit(told, weight, tmp_path):
    search = search_of(tmp_path, weight, **told)
    assert out_of_scale(search, search.models.fitted((), {})) == ""
