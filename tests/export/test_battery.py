"""Every effect of the library goes home: played on held-out logs it is the same to a per cent.

What was written is played in this process here; `test_exporting` lets them run apart.
"""

import ctypes
import math
import shutil
from pathlib import Path

import pytest

from spirob.effects import all_effects, find_effects
from spirob.effects.motor import quadratic_drag
from spirob.export import targets
from spirob.export.exporting import LOSS, about_of
from spirob.export.heldout import Heldout
from spirob.files import write_text
from spirob.machine.laws import for_axis
from spirob.machine.search.preparation import applicable
from tests.export import machines
from tests.export.machines import exported_model, numbers_of, rig_of


def shown(effects, hung):
    """Names of those that a plain axis can show, of a commanded effort or a measured one."""
    body = {"body": {"mjcf": "pendulum.xml", "joint": "elbow", "tip": "tip"}} if hung else {}
    known = {"column": "i", "unit": "A", "kind": "current"}
    found = set()
    for origin in ("command", "measured"):
        rig = rig_of(hung, effort={**known, "origin": origin}, **body)
        laws = list(for_axis(effects, 0.0 if hung else 2.0, "motor", not hung))
        found |= {law.name() for law in applicable(laws, rig, hung, 0.4, True)[0]}
    return found


PLAIN = shown(all_effects().values(), hung=False)
HINGED = shown(all_effects().values(), hung=True) - PLAIN
OF_THE_ARM = set(all_effects()) - PLAIN - HINGED  # `test_arm` and `test_kernels`
NATIVE = {  # what plain MJCF holds, within this share of its size
    "cogging", "constant_force", "coulomb_friction", "current_gain", "current_lag",
    "current_offset", "feedback_latency", "gear_compliance", "joint_viscoelasticity",
    "mount_tilt", "parallel_spring", "presliding_friction", "quadratic_drag", "rest_curvature",
    "stiffness_hardening", "stribeck_friction", "tip_payload",
}  # fmt: skip
SAID = 0.05
COMPILER = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler is installed here"
)


@pytest.fixture(scope="module", params=sorted(PLAIN | HINGED))
def machine(request, tmp_path_factory):
    """The effect's name, its model, and a folder."""
    folder = tmp_path_factory.mktemp(request.param)
    body = request.param in HINGED
    return request.param, exported_model(folder, [request.param], body, seconds=1.5), folder


def test_what_reads_a_signal_that_a_plain_axis_lacks_is_left_to_the_arm(tmp_path):
    source = Path(quadratic_drag.__file__).read_text()
    for name, signal in (("drum_drag", "winch.angle"), ("turn_drag", "motor.angle")):
        changed = source.replace('"motor.speed"', f'"{signal}"')
        assert changed != source
        (tmp_path / f"{name}.py").write_text(changed)
    effects = find_effects([str(tmp_path / "drum_drag.py"), str(tmp_path / "turn_drag.py")])
    assert shown(effects, hung=False) == {"turn_drag"}
    assert shown(effects, hung=True) == {"turn_drag"}
    acts = {part for name in OF_THE_ARM for part in all_effects()[name].port.split(".")[:1]}
    assert acts <= {"tendon", "winch", "motor"}
    assert {"capstan_friction", "creep", "drum_build_up", "eccentric_winch"} <= OF_THE_ARM
    assert OF_THE_ARM.isdisjoint(NATIVE)
    assert {"joint_viscoelasticity", "mount_tilt", "rest_curvature"} <= HINGED


def lost(model, target, folder):
    """What a target loses of the effect."""
    there, place = targets()[target], folder / target
    for name, text in there.files(model).items():
        write_text(place / name, text)
    heldout = Heldout(model)
    errors = heldout.errors(**there.play(place, about_of(model, target), heldout.given()))
    assert errors.size > 0.0
    return errors.lost


def test_mjcf_holds_a_breakaway_peak_that_turns_round_within_a_step(tmp_path, monkeypatch):
    def at_once(problem, names):
        way = "stribeck_friction.presliding"
        return numbers_of(problem, names) | {way: problem.table.about[way].low}

    monkeypatch.setattr(machines, "numbers_of", at_once)
    assert (
        lost(exported_model(tmp_path, ["stribeck_friction"], seconds=1.5), "mjcf", tmp_path) < SAID
    )


MACHINES = {
    "sensor at the load": {"position": {"column": "q", "unit": "rad", "side": "load"}},
    "slide in volts": {
        "position": {"column": "q", "unit": "m"},
        "effort": {"column": "i", "unit": "V", "kind": "voltage", "origin": "command"},
        "known": {"scale": 0.5, "inertia": 0.02, "back_emf": 0.1, "delay": 0.004},
    },
    "slow log": {"step": 5e-3},
    "a spring": {"known": {"scale": 0.5, "inertia": 0.02, "stiffness": 0.3, "delay": -0.002}},
    "logs that differ": {"logs": {"log": {"offset": 0.05, "zero": 0.3}}},
}


@COMPILER
@pytest.mark.parametrize("kind", MACHINES)
def test_machines_of_every_kind_are_the_same(kind, tmp_path):
    side = "load" if "load" in kind else "motor"
    names = ["gear_compliance"] if side == "load" else ["presliding_friction", "current_lag"]
    model = exported_model(tmp_path, names, side=side, **MACHINES[kind])
    assert lost(model, "c", tmp_path) < LOSS
    assert lost(model, "mujoco", tmp_path) < LOSS


@COMPILER
def test_c_holds_it(machine):
    _, model, folder = machine
    assert lost(model, "c", folder) < LOSS


def test_mujoco_holds_it(machine):
    _, model, folder = machine
    assert lost(model, "mujoco", folder) < LOSS


def test_mjcf_holds_it_or_says_that_it_does_not(machine):
    name, model, folder = machine
    share = lost(model, "mjcf", folder)
    text = next((folder / "mjcf").glob("*.xml")).read_text()
    if name in NATIVE:
        assert share < SAID
        assert f"holds {name}" in text
    else:
        assert share > SAID
        assert f"leaves out {name}: costs " in text


@COMPILER
def test_what_is_not_finite_leaves_the_c_state_as_it_is(tmp_path):
    model = exported_model(tmp_path, ["presliding_friction", "gear_compliance"], seconds=1.5)
    for name, text in targets()["c"].files(model).items():
        write_text(tmp_path / name, text)
    library, about = targets()["c"].compiled(tmp_path, "elbow", tmp_path), about_of(model, "c")
    state = (ctypes.c_double * len(about["fields"]))()
    call = library.elbow_compensate
    call.restype, call.argtypes = ctypes.c_double, [ctypes.c_void_p, *[ctypes.c_double] * 4]
    call(state, 0.1, 0.5, 1.0, 1e-3)
    kept = list(state)
    for wrong in ((math.nan, 0.0, 0.0, 1e-3), (0.0, math.inf, 0.0, 1e-3), (0.0, 0.0, 0.0, -1.0)):
        assert call(state, *wrong) == 0.0
        assert list(state) == kept
    assert math.isfinite(call(state, 0.1, 0.5, 1.0, 1e-3))
