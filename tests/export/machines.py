"""Axes whose model is known, with their held-out motion, as a diagnosis would have kept them."""

import json
from types import SimpleNamespace

import numpy as np

from spirob.effects import all_effects
from spirob.export.corrected import corrected, read_document
from spirob.identify.intervals import Estimate
from spirob.machine.document import heldout, plain, standing
from spirob.machine.inverse.body import RigidBody
from spirob.machine.inverse.numbers import log_numbers
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import sizes_of
from spirob.machine.laws import for_axis
from spirob.machine.loading import described
from spirob.machine.recordings.recording import prepare
from tests.documents import document

PENDULUM = """
<mujoco>
  <option gravity="0 0 -9.81"/>
  <worldbody>
    <body name="arm">
      <inertial pos="0.2 0 0" mass="0.3" diaginertia="0.01 0.01 0.01"/>
      <joint name="elbow" axis="0 0 1" stiffness="0.4" damping="0.01"/>
      <site name="tip" pos="0.4 0 0"/>
    </body>
  </worldbody>
</mujoco>
"""
STEP = 1e-3
TONES = ((0.8, 0.3, 0.0), (0.3, 0.9, 1.0), (0.08, 2.3, 2.0))  # rad, Hz, rad
# what an effect is made of besides its nominal numbers, so that all of it shows
MORE = {
    "cogging": {"cosine": 0.5, "second_sine": 0.3, "third_cosine": 0.2},
    "torque_ripple": {"cosine": 0.02, "second_sine": 0.01},
    "encoder_eccentricity": {"cosine": 0.5, "second_sine": 0.3},
    "mount_tilt": {"pitch": 0.05},
    "tip_payload": {"cosine": 0.5},
    "parallel_spring": {"bias": 0.3},
}


def motion(seconds=6.0, step=STEP):
    """Time and position of a sum of tones."""
    t = np.arange(0.0, seconds, step)
    return t, sum(a * np.sin(2 * np.pi * f * t + p) for a, f, p in TONES)


def rig_of(hung, **more):
    """A description of an axis in torque, or with a current of 0.5 N·m/A."""
    told = {
        "name": "elbow",
        "time": {"column": "t", "unit": "s"},
        "position": {"column": "q", "unit": "rad", "side": "motor"},
        "effort": {"column": "i", "unit": "A", "kind": "current", "origin": "command"},
        "known": {"scale": 0.5, "delay": 0.0, "inertia": 0.005 if hung else 0.02},
        "fit": {"viscous": {"nominal": 0.03, "low": 0.0, "high": 1.0}},
        "gear": 3.0,
        "filter": {"cutoff": 30.0},
        "rows": {"standstill": "keep"},
    }
    return described({**told, **more}, "rig")


def problem_of(folder, names, body=False, side="motor", step=STEP, seconds=6.0, **more):
    """The inverse problem of one log with these effects."""
    described_body = {}
    if body:
        (folder / "pendulum.xml").write_text(PENDULUM)
        described_body = {"body": {"mjcf": "pendulum.xml", "joint": "elbow", "tip": "tip"}}
    rig = rig_of(body, **described_body, **more)
    t, q = motion(seconds, step)
    a = np.gradient(np.gradient(q, t), t)
    recording = prepare("log", {"t": t, "q": q, "i": 0.06 * a + 0.1 * np.sin(9 * t)}, rig)
    made = RigidBody(rig.body, folder, True) if body else None
    effects = for_axis((all_effects()[n] for n in names), 0.0 if body else 2.0, side, not body)
    sizes, rest = sizes_of(rig, made, [recording])
    logs = log_numbers(rig, [recording], sizes)
    return InverseProblem(rig, made, [recording], effects, sizes, rest, logs)


def numbers_of(problem, names):
    """All numbers of a machine whose effects are there, each as large as it usually is."""
    table = problem.table
    found: dict[str, float] = {}
    for effect in problem.effects:
        for field in effect.parameters():
            found[f"{effect.name()}.{field}"] = table.about[f"{effect.name()}.{field}"].nominal
        first = next(iter(effect.neutral))
        if "load_inertia" in effect.parameters():
            found[f"{effect.name()}.load_inertia"] = 0.012  # of 0.02
        size = found[f"{effect.name()}.{first}"]
        for field, share in MORE.get(effect.name(), {}).items():
            if field in effect.parameters():
                like = 1.0 if effect.name() in ("torque_ripple", "mount_tilt") else size
                found[f"{effect.name()}.{field}"] = share * like
    return found


def exported_model(folder, names, body=False, zero=(), **more):
    """A corrected model on disk, as a diagnosis leaves it, and read again; `zero` are absent."""
    problem = problem_of(folder, names, body, **more)
    changes = numbers_of(problem, names)
    for effect in (e for e in problem.effects if e.name() in zero):
        changes |= {f"{effect.name()}.{field}": value for field, value in effect.neutral.items()}
    value = 0.03
    rows = len(problem.measured())
    rng = np.random.default_rng(0)
    fitted = SimpleNamespace(
        changes={**changes, "rig.viscous": value},
        estimates={"rig.viscous": Estimate(value, 0.029, 0.031, "N·m·s/rad", False)},
        jacobian=rng.normal(size=(rows, 1)),
        residual=rng.normal(size=rows),
    )
    model = SimpleNamespace(fit=fitted)
    size = float(np.sqrt(np.mean(problem.measured() ** 2)))
    models = SimpleNamespace(train=problem, heldout=problem, size=size, robust=10.0 * size)
    search = SimpleNamespace(models=models)
    told = document(rig="elbow", model=plain(standing(search, model, problem.body)))
    (folder / "diagnosis.json").write_text(json.dumps(told))
    heldout(search, model).to_parquet(folder / "heldout.parquet")
    return corrected(read_document(folder / "diagnosis.json"), folder)
