"""The arm goes home: its coupled loop beside plain MuJoCo plays as the model does, every effect."""

import importlib.util
import json

import mujoco
import numpy as np
import pytest

from spirob.control import CURRENT, VELOCITY, Schedule
from spirob.effects import all_effects
from spirob.errors import ExportError
from spirob.export.arm import CorrectedArm, corrected_arm, motor_of
from spirob.export.arm_mujoco import arm_module, with_tendons
from spirob.export.body import bare
from spirob.export.code import c_files_of_arm
from spirob.export.targets import bam, mjcf, table
from spirob.plant import Rig
from spirob.robot import Scene

CYCLES = 120
LOSS = 0.01
WEAK = {"drive.voltage_limit": 1.5}  # V: a supply that sags has to be at its limit
STRONG = {  # a small bend, and a body written in six digits; a supply at its limit now and then
    "stiffness_hardening.hardening": 20.0,
    "supply_sag.supply_resistance": 5.0,
}


def arm_of(names, changes=None):
    """An arm with these effects at their nominal numbers."""
    effects = tuple(all_effects()[n] for n in names)
    nominal = {f"{e.name()}.{f}": a.nominal for e in effects for f, a in e.parameters().items()}
    changes = nominal if changes is None else changes
    return CorrectedArm(
        "spirob", "named", "Missing.", Rig(), effects, changes, {}, None, ()
    )  # fmt: skip


def gentle():
    """The left motor winds in and pays out slowly while the right one holds lightly."""
    t = np.arange(CYCLES) * 1e-3
    reference = np.zeros((CYCLES, 2))
    reference[:, 0] = 0.03 * np.sin(2 * np.pi * 12.0 * t) + 0.02
    reference[:, 1] = 0.2
    mode = np.array([VELOCITY, CURRENT])
    return Schedule(mode, reference, np.zeros_like(reference), np.full(2, 10.0))


class Home:
    """An exported arm as somebody else loads it."""

    def __init__(self, model, folder):
        told = {"title": "spirob", "sentence": "Missing."}
        (folder / "spirob.py").write_text(arm_module(model, "spirob", told))
        (folder / "spirob.xml").write_text(bare(model).text([]))
        spec = importlib.util.spec_from_file_location("spirob_home", folder / "spirob.py")
        self.module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self.module)
        self.body = mujoco.MjModel.from_xml_path(str(folder / "spirob.xml"))

    def play(self, schedule):
        """Readings of every cycle: current, arm_current, displacement, tension, (T, 2) each."""
        data, controller = mujoco.MjData(self.body), self.module.Controller(self.body)
        controller.start(self.body, data)
        controller.mode[:], controller.limit[:] = schedule.mode, schedule.current_limit
        read = {n: [] for n in ("current", "arm_current", "displacement", "tension")}
        for k in range(schedule.cycles):
            controller.reference[:] = schedule.reference[k]
            for step in range(2):
                controller.before_step(self.body, data)
                if step == 0:
                    for name, rows in read.items():
                        rows.append(controller.read(name))
                mujoco.mj_step(self.body, data)
        return {name: np.array(rows) for name, rows in read.items()}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The arm with all effects, each absent: the model, its plant, and the arm at home."""
    names = sorted(all_effects())
    effects = [all_effects()[n] for n in names]
    absent = {f"{e.name()}.{f}": v for e in effects for f, v in e.neutral.items()}
    model = arm_of(names, absent)
    return model, model.plant(), Home(model, tmp_path_factory.mktemp("home"))


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("name", sorted(all_effects()))
def test_an_effect_is_the_same_at_home(name, whole, tmp_path):
    model, plant, home = whole
    schedule, effect = gentle(), all_effects()[name]
    base = model.changes | (WEAK if name == "supply_sag" else {})
    numbers = {f"{name}.{f}": about.nominal for f, about in effect.parameters().items()}
    numbers |= {full: value for full, value in STRONG.items() if full in numbers}
    changes = {**base, **numbers}
    if effect.port.startswith("body."):  # part of the body, or of where it hangs
        home = Home(arm_of([name], numbers), tmp_path)
    else:
        home.module.P[:] = plant.table.vector(changes)
    wanted = plant.simulate(schedule, Scene(), changes)
    without = plant.simulate(schedule, Scene(), base)
    found = home.play(schedule)
    shown = 0
    for signal, values in found.items():
        ours, bare_ = getattr(wanted, signal), getattr(without, signal)
        size = rms(ours - bare_)
        if size > 1e-6 * max(rms(ours), 1e-12):
            shown += 1
            assert rms(values - ours) < LOSS * size, signal
    assert shown


def test_a_gentle_trial_has_the_same_currents(whole):
    model, plant, home = whole
    home.module.P[:] = plant.table.vector(model.changes)
    ours = plant.simulate(gentle(), Scene(), model.changes).current
    assert rms(home.play(gentle())["current"] - ours) < 0.005 * rms(ours)


def test_a_motor_in_c_is_an_axis_of_its_own():
    names = ["coulomb_friction", "capstan_friction", "constant_force", "torque_ripple"]
    model = arm_of(names)
    left = motor_of(model, "left")
    rig = model.rig
    assert [e.name for e in left.effects] == ["coulomb_friction", "constant_force", "torque_ripple"]
    assert left.own_inertia == rig.motor.rotor_inertia
    assert left.numbers["scale"] == pytest.approx(rig.winch.efficiency * rig.motor.torque_constant)
    files = c_files_of_arm(model)
    assert "kernel_capstan_friction" in files["spirob_laws.h"]
    assert "kernel_capstan_friction" not in files["spirob_left.c"]


def test_plain_mjcf_holds_what_it_says():
    names = ["stiffness_hardening", "rest_curvature", "tip_payload", "coulomb_friction", "creep"]
    _, held, outside = with_tendons(arm_of(names))
    assert set(outside) - {"arm.bends_per_hinge"} == {"creep"}
    assert set(held) == set(names) - {"creep"}
    text = mjcf.arm(arm_of(names))["spirob.xml"]
    made = mujoco.MjModel.from_xml_string(text)
    assert "leaves out creep" in text
    assert made.ntendon == made.nu == 2
    winches = [made.joint(f"{motor}_winch").dofadr[0] for motor in ("left", "right")]
    assert np.all(made.dof_frictionloss[winches] > 0.0)
    assert np.all(made.tendon_lengthspring[:, 0] == 0.0)  # they pull, and go slack
    assert made.body("tip").mass[0] == pytest.approx(0.02)


def test_what_a_pipeline_leaves_is_read(tmp_path):
    data = tmp_path / "data"
    (data / "diagnosis").mkdir(parents=True)
    (data / "config").mkdir()
    told = {"effects": ["coulomb_friction"], "changes": {"coulomb_friction.coulomb_torque": 0.003}}
    (data / "diagnosis/model.json").write_text(json.dumps(told))
    config = "rig: {name: spirob}\nrecordings: {trials: [{name: deep, role: heldout}]}\n"
    (data / "config/config.yaml").write_text(config)
    number = {"value": 0.003, "low": 0.002, "high": 0.004, "unit": "N·m"}
    (data / "identified").mkdir()
    damping = {"value": 2e-5, "low": 1e-5, "high": 3e-5, "unit": "N·m·s/rad"}
    share = {"value": 0.7, "low": 0.6, "high": 0.8, "unit": "1"}
    base = {"parameters": {"motor.rotor_damping": damping, "winch.efficiency": share}}
    names = list(base["parameters"])
    base["resolution"] = {"names": names, "correlation": [[1.0, 0.5], [0.5, 1.0]]}
    (data / "identified/base.json").write_text(json.dumps(base))
    document = {
        "verdict": "named",
        "sentence": "Missing: dry friction.",
        "effects": [{"name": "coulomb_friction", "parameters": {"coulomb_torque": number}}],
    }
    model = corrected_arm(document, data / "diagnosis")
    assert model.heldout == ("deep",)
    files = table.arm(model)
    assert "coulomb_friction.coulomb_torque,0.003,0.002,0.004" in files["parameters.csv"]
    drawn = json.loads(files["randomisation.json"])
    covariance, sigma = np.array(drawn["covariance"]), np.array([2e-5, 0.2, 0.002]) / 3.92
    order = [drawn["names"].index(n) for n in (*names, "coulomb_friction.coulomb_torque")]
    correlation = covariance[np.ix_(order, order)] / np.outer(sigma, sigma)
    assert correlation == pytest.approx(np.array([[1, 0.5, 0], [0.5, 1, 0], [0, 0, 1]]))
    with pytest.raises(ExportError, match=r"deep\.parquet"):
        model.trials()
    told["effects"] = ["data/config/effects/0123/my_own.py"]  # a path, as of any file
    (data / "diagnosis/model.json").write_text(json.dumps(told))
    with pytest.raises(ExportError, match="'my_own' is none of the library"):
        corrected_arm(document, data / "diagnosis")
    (data / "config/config.yaml").unlink()
    with pytest.raises(ExportError, match=r"config.yaml: .*diagnose again"):
        corrected_arm(document, data / "diagnosis")


def test_a_motor_is_a_servo_of_bam():
    model = arm_of(["coulomb_friction", "load_dependent_friction", "capstan_friction"])
    told = {name: json.loads(text) for name, text in bam.arm(model).items()}
    assert set(told) == {"spirob_left_m5.json", "spirob_right_m5.json"}
    left, rig = told["spirob_left_m5.json"], model.rig
    assert left["armature"] == pytest.approx(rig.motor.rotor_inertia)
    assert left["friction_base"] == model.changes["coulomb_friction.coulomb_torque"]


def test_an_arm_that_was_logged_elsewhere_is_read(tmp_path):
    told = {
        "format": 1,
        "machine": "arm",
        "rig": {"winch": {"gear_ratio": 12.0}},
        "effects": ["coulomb_friction"],
        "changes": {"coulomb_friction.coulomb_torque": 0.003, "winch.radius": 0.02},
    }
    document = {
        "rig": "mine",
        "verdict": "named",
        "sentence": "Missing: dry friction.",
        "effects": [],
        "numbers": {"winch.radius": {"value": 0.02, "low": 0.01, "high": 0.03, "unit": "m"}},
        "model": told,
    }
    model = corrected_arm(document, tmp_path)
    lever = motor_of(model, "left")
    assert model.rig.winch.gear_ratio == 12.0
    assert lever.effects[0].values["coulomb_torque"] == 0.003
    assert "winch.radius,0.02,0.01,0.03" in table.arm(model)["parameters.csv"]
    with pytest.raises(ExportError, match="no trial of the arm"):
        model.trials()
    for broken in (
        {**told, "format": 2},
        {**told, "rig": {"wings": {}}},
        {**told, "changes": None},
    ):
        with pytest.raises(ExportError):
            corrected_arm({**document, "model": broken}, tmp_path)
