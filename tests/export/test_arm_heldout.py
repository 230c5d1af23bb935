"""An exported arm is played on the trials that were kept aside, by every target that holds one."""

import json
import shutil
from dataclasses import dataclass

import mujoco
import numpy as np
import pytest

from spirob.cli.main import main
from spirob.control import CURRENT, VELOCITY, Schedule
from spirob.effects import all_effects
from spirob.export import arm, exporting, targets
from spirob.export.arm import CorrectedArm, lever_of
from spirob.export.heldout import PLAYED, ArmHeldout
from spirob.files import write_text
from spirob.identify.measurement import Measurement
from spirob.plant import Plant, Rig
from spirob.robot import Scene
from tests.documents import document

CYCLES = 900
SAID = 0.05
GENTLE = 0.005
STRONG, STRENGTHS = 4.0, ("quadratic_drag.drag",)  # beside 2 mA of the bare arm
HELD = ["coulomb_friction", "presliding_friction", "quadratic_drag"]
COMPILER = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler is installed here"
)


@dataclass(frozen=True)
class Kept(CorrectedArm):
    """An arm with one trial that was kept aside, as its own model plays it."""

    def trials(self):
        t = np.arange(CYCLES) * 1e-3
        reference = np.column_stack(
            [0.03 * np.sin(2 * np.pi * 1.1 * t), 0.3 * np.minimum(1.0, t / 0.2)]
        )
        none, limits = np.zeros_like(reference), np.full(2, 10.0)
        schedule = Schedule(np.array([VELOCITY, CURRENT]), reference, none, limits)
        first = (0.7, 2.1)
        played = self.plant().simulate(schedule, Scene(), self.changes, first)
        signals = played.current, played.displacement, played.velocity
        return [Measurement("kept", "heldout", *signals, schedule, Scene(), first)]


def arm_of(names, changes=None):
    """An arm with these effects at their nominal numbers."""
    effects = tuple(all_effects()[n] for n in names)
    nominal = {f"{e.name()}.{f}": a.nominal for e in effects for f, a in e.parameters().items()}
    changes = {"arm.bends_per_hinge": 1.0, **nominal, **(changes or {})}
    return Kept("spirob", "named", "Missing.", Rig(), effects, changes, {}, None, ())


def errors(model, target, folder):
    """What a target makes of the trial."""
    for name, text in targets()[target].arm(model).items():
        write_text(folder / name, text)
    heldout = ArmHeldout(model)
    return heldout.errors(PLAYED[target](heldout, folder))


@pytest.mark.parametrize("target", ["mjcf", "mujoco", pytest.param("c", marks=COMPILER)])
def test_a_gentle_trial_asks_for_the_same_currents(target, tmp_path):
    found = errors(arm_of([]), target, tmp_path)
    assert found.size == pytest.approx(found.ours + found.size, abs=1e-9)  # it is its own log
    assert found.apart < GENTLE * found.size


@pytest.mark.parametrize("name", HELD)
def test_plain_mjcf_holds_what_a_rotor_has(name, tmp_path):
    model = arm_of([name])
    strong = {n: STRONG * model.changes[n] for n in STRENGTHS if n in model.changes}
    assert errors(arm_of([name], strong), "mjcf", tmp_path).lost < SAID


@COMPILER
def test_a_motor_in_c_obeys_its_own_equation(tmp_path):
    model = arm_of(["coulomb_friction"])
    for name, text in targets()["c"].arm(model).items():
        write_text(tmp_path / name, text)
    heldout = ArmHeldout(model)
    (found,), (ours,) = PLAYED["c"](heldout, tmp_path), heldout.ours
    motor, winch = model.rig.motor, model.rig.winch
    speed = winch.gear_ratio / winch.radius * ours.velocity[:, 0]
    level, softness = (
        model.changes[f"coulomb_friction.{n}"] for n in ("coulomb_torque", "softness")
    )
    torque = motor.rotor_inertia * np.gradient(speed, 1e-3) + motor.rotor_damping * speed
    torque += level * np.tanh(speed / (softness * motor.rest_speed))
    torque += winch.radius / winch.gear_ratio * ours.tension[:, 0]
    wanted = torque / (winch.efficiency * motor.torque_constant)
    assert lever_of(model, "left") == winch.radius / winch.gear_ratio
    assert found[:, 0] == pytest.approx(wanted, abs=1e-9)


def test_what_plain_mjcf_leaves_out_has_its_size(tmp_path):
    model = arm_of(["capstan_friction"], {"arm.bends_per_hinge": 2.0})
    text = targets()["mjcf"].arm(model)["spirob.xml"]
    assert "leaves out capstan_friction: costs " in text
    assert "leaves out arm.bends_per_hinge: costs " in text
    mujoco.MjModel.from_xml_string(text)


class Line:
    """A residual that is linear in two numbers of the arm, with white noise."""

    table, block = Plant(Rig()).table, 10
    names = ("motor.rotor_damping", "tendon.damping")

    def __init__(self):
        rng, n = np.random.default_rng(3), 4000
        self.edges, noise = np.array([0, n]), rng.normal(0.0, 0.01, n)
        first = rng.normal(size=n)
        self.slopes = np.column_stack([first, 0.8 * first + 0.6 * rng.normal(size=n)])
        start = {n: float(self.table.values[self.table.position(n)]) for n in self.names}
        self.start, self.noise = np.array([*start.values()]), noise

    def __call__(self, changes):
        at = np.array([changes[n] for n in self.names])
        return self.slopes @ (at / self.start - 1.0) + self.noise

    def many(self, points):
        return [self(point) for point in points]


def test_numbers_that_do_the_same_are_correlated(monkeypatch):
    line = Line()
    monkeypatch.setattr(arm, "_residual", lambda model: (line, 100.0))
    found = arm.correlation_of(arm_of([]), Line.names)
    inverse = np.linalg.inv(line.slopes.T @ line.slopes)
    wanted = inverse[0, 1] / np.sqrt(inverse[0, 0] * inverse[1, 1])
    assert found[0, 1] == pytest.approx(wanted, abs=0.1)
    assert found == pytest.approx(found.T)
    assert np.diag(found).tolist() == [1.0, 1.0]


@pytest.mark.parametrize("target", ["mjcf", "bam"])
def test_a_lossy_arm_says_so_in_its_first_line(target, tmp_path, monkeypatch):
    (tmp_path / "diagnosis.json").write_text(json.dumps(document()))
    model = arm_of(["capstan_friction", "cogging"])
    monkeypatch.setattr(exporting, "_model", lambda document, folder: model)
    out = tmp_path / "out"
    assert main(["export", str(tmp_path), "--to", target, "--out", str(out)]) == 0
    told = json.loads((out / "check.json").read_text())
    assert told["lost"] > 0.01
    assert all("LOSES" in file.read_text().splitlines()[0] for file in out.iterdir())
