"""The whole way on short trials: complete, idempotent, blind to the truth, survives a kill."""

import json
import random
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from pipeline import ask, decide
from spirob.diagnosis.proposals import ROLES, TRIALS, bend
from spirob.emulator import EmulatedRig, HiddenSettings
from spirob.emulator.machine import Machine
from spirob.export.arm import corrected_arm, correlation_of
from spirob.robot import MOTORS
from tests.pipeline.project import DECIDING, MEASURED, ONE_CORE, SHORT, Project

# three of the eleven numbers, of a robot that needs no more, in the first two moves of each bend:
# a verdict is not what is asked here
QUICK = [
    *SHORT,
    *(f"recordings.trials.{k}.duration={d}" for k, d in enumerate((3.0, 3.0, 2.5, 2.5))),
    "diagnose.iterations=1",
    "diagnose.patience=1",
    "identify.parameters=[winch.efficiency,motor.rotor_damping,arm.base_stiffness]",
    "robot.build=as_designed",
    "passive.in_model=8",
    "passive.on_robot=1",
    "passive.free=0",
    "perceive.repeats=1",
    "+perceive.wrap={speed: 0.08, duration: 2.6}",
]
STAGES = {  # in the order in which they run: about how long each takes [s]
    "config": 3,
    "collect": 6,
    "decode": 3,
    "identify": 8,
    "compare": 4,
    "diagnose": 8,
    "ask": 3,
    "decide": 4,
    "experiments": 6,
    "passive": 5,
    "wraps": 5,
    "features": 5,
    "train": 4,
    "transfer": 8,
    "evaluate": 4,
    "trial": 12,
    "trial_full": 3,
    "report": 4,
}
METRICS = [
    "compare",
    "diagnose",
    "experiments",
    "identify",
    "passive",
    "score",
    "size",
    "transfer",
    "trial",
    "trial_full",
]


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    Machine(EmulatedRig(), HiddenSettings(), 0).cycle((0.0, 0.0))  # compiled before it is copied
    project = Project(tmp_path_factory.mktemp("project"), QUICK)
    project.repro()
    return project


def test_report_and_metrics_are_there(finished):
    page = (finished.root / "reports/index.html").read_text()
    assert "<html" in page
    made = set(finished.metrics()) - {Path(MEASURED).name}
    assert sorted(made) == [f"{name}.json" for name in METRICS]
    size = json.loads(finished.metrics()["size.json"])
    assert {"mae", "rmse", "r2", "std"} <= set(size["robot"])
    assert {"mae", "rmse", "r2", "std"} <= set(size["simulation"])
    assert "diagnose.json" in finished.run(sys.executable, "-m", "dvc", "metrics", "show")


def test_what_is_taken_home_knows_how_its_numbers_vary_together(finished):
    folder = finished.root / "data/diagnosis"
    model = corrected_arm(json.loads((folder / "diagnosis.json").read_text()), folder)
    names = ("winch.efficiency", "motor.rotor_damping")
    told = correlation_of(model, names)
    assert np.abs(np.diag(told) - 1.0).max() == 0.0
    assert 0.0 < abs(told[0, 1]) < 1.0


def test_a_second_run_has_nothing_to_do(finished):
    assert "up to date" in finished.repro()


def test_no_log_and_no_public_file_names_the_hidden_effect(finished):
    hidden = b"guide_friction"
    open_files = [p for p in (finished.root / "data").rglob("*") if p.is_file()]
    open_files = [p for p in open_files if p.name not in ("hidden.yaml", "truth.json")]
    assert any(p.suffix == ".mcap" for p in open_files)
    assert [p for p in open_files if hidden in p.read_bytes()] == []


def test_diagnosis_has_the_same_bits_without_the_truth(finished, tmp_path):
    """The truth file is deleted and the configuration names another hidden effect."""
    blind = tmp_path / "blind"
    decided = finished.copied(blind, ".dvc", ".git")
    shutil.rmtree(blind / "data/truth")
    decided.override([*QUICK, "robot.hidden.effect=winding_heating", "robot.hidden.seed=99"])
    decided.stages(("config", "decode", *DECIDING))
    assert b"winding_heating" in (blind / "data/config/hidden.yaml").read_bytes()
    for file in ("data/identified/base.json", "data/diagnosis/diagnosis.json"):
        assert (blind / file).read_bytes() == (finished.root / file).read_bytes()


SAID = ("sentence", "verdict")


def asking(finished, folder, decide=(), prove=(), effects=(), verdict=None, off=None, far=("",)):
    """A copy of the project whose search ended with these models, and what it asks for was played.

    verdict  what stands otherwise in that of the search
    off      numbers that are not as they were identified, in the models `far`: by default in that
             without any effect
    """
    project = finished.copied(folder / "asking", ".dvc", ".git")
    for stale in ("data/asked", "data/diagnosis"):
        shutil.rmtree(project.root / stale)
    plain = json.loads((project.root / "data/identified/base.json").read_text())["changes"]
    sides = {
        "": plain,
        "coulomb_friction": {**plain, "coulomb_friction.coulomb_torque": 1e-4},
        "capstan_friction": {**plain, "capstan_friction.friction": 0.03},
    }
    models = [
        {"effects": [name] * bool(name), "names": ["winch.efficiency"], "changes": numbers}
        for name in ("", *effects)
        for numbers in [{**sides[name], **(off or {})} if name in far else sides[name]]
    ]
    question = project.root / "data/search/question.json"
    told = json.loads(question.read_text()) | {"decide": decide, "prove": prove}
    told["models"] = models
    sure = {"probability": 0.9, "together": 0.9, "equivalents": [], "figures": {}}
    weighed = {name: {**sure, "rivals": list(effects[1:])} for name in effects[:1]}
    said = {k: v for k, v in (verdict or {}).items() if k != "verdict"}
    told["verdict"] |= {"weighed": weighed, **said}
    question.write_text(json.dumps(told))
    for file in ("diagnosis.json", "metrics.json"):
        path = project.root / "data/search" / file
        said = {key: value for key, value in (verdict or {}).items() if key in SAID}
        path.write_text(json.dumps(json.loads(path.read_text()) | said))
    with pytest.MonkeyPatch.context() as patched:
        for name, value in ONE_CORE.items():
            patched.setenv(name, value)
        ask.stage(project.root)
    return project


def decided(project):
    """The diagnosis that stands, without the truth at hand; no law is composed of what is left."""
    shutil.rmtree(project.root / "data/truth")
    (project.root / "data/config/hidden.yaml").unlink()
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(decide, "composed", lambda *of: None)
        decide.stage(project.root)
    found = json.loads((project.root / "data/diagnosis/diagnosis.json").read_text())
    assert json.loads(project.metrics()["diagnose.json"])["verdict"] == found["verdict"]
    for file in ("overlay.parquet", "combinations.parquet", "motion.parquet", "model.json"):
        assert (project.root / "data/diagnosis" / file).exists()
    return found


def experiment(name):
    """One of the list, as plain data."""
    moves, load = next((moves, load) for own, moves, load in TRIALS if own == name)
    trials = [bend(f"{m}_leads", r, m, moves, load) for m, r in zip(MOTORS, ROLES, strict=True)]
    return {"name": name, "trials": trials, "difference": 0.1, "share": 0.1, "proves": False}


def test_what_is_contested_is_asked_of_the_robot_and_decided_blind(finished, tmp_path):
    """As if dry friction had stood beside the right name: the trials are played, then judged
    without the truth."""
    sides = ("coulomb_friction", "capstan_friction")
    project = asking(finished, tmp_path, decide=[experiment("slow crawl")], effects=sides)
    played = sorted(p.name for p in (project.root / "data/asked").iterdir())
    assert played == ["left_leads.mcap", "right_leads.mcap"]
    found = decided(project)
    assert found["asked"]["experiment"] == "slow crawl"
    assert found["candidates"][0]["name"] == "capstan_friction"


@pytest.mark.parametrize(("stiffness", "holds"), [(0.2, True), (1.0, False)])
def test_a_name_is_put_to_the_proof_on_the_robot(finished, tmp_path, stiffness, holds):
    """As if the search had named it: it stands beside a model that is far off, else it falls, and
    its model with it."""
    identified = json.loads((finished.root / "data/identified/base.json").read_text())
    off = {"arm.base_stiffness": stiffness * identified["changes"]["arm.base_stiffness"]}
    effect = "capstan_friction"
    named = {"kind": "named", "verdict": "named", "sentence": "Missing: some friction."}
    proof = [experiment("hold")]
    project = asking(finished, tmp_path, prove=proof, effects=(effect,), verdict=named, off=off)
    found = decided(project)
    assert found["proof"]["experiment"] == "hold"
    assert found["proof"]["holds"] is holds
    assert found["verdict"] == ("named" if holds else "unknown")
    if not holds:
        assert "not some friction" in found["sentence"]
        model = json.loads((project.root / "data/diagnosis/model.json").read_text())
        assert model["effects"] == found["effects"] == []
        assert effect not in json.dumps(model)


def test_of_rivals_the_one_that_holds_is_left(finished, tmp_path):
    """As if dry friction, in a model that is far off, had been found, and stood beside another."""
    identified = json.loads((finished.root / "data/identified/base.json").read_text())
    off = {"arm.base_stiffness": 0.2 * identified["changes"]["arm.base_stiffness"]}
    sides = ("coulomb_friction", "capstan_friction")
    project = asking(
        finished,
        tmp_path,
        prove=[experiment("hold")],
        effects=sides,
        verdict={"kind": "undecided", "verdict": "undecided"},
        off=off,
        far=("", sides[0]),
    )
    found = decided(project)
    assert found["proof"]["holds"]
    assert [c["name"] for c in found["candidates"]] == ["capstan_friction"]
    assert found["verdict"] != "undecided"


KILLED = 2  # stages of a run, others in each run: each costs about what it takes to play it twice


def test_a_run_that_is_killed_in_some_stages_ends_with_the_same_metrics(finished, tmp_path):
    """Of a finished run these stages are forgotten, and each is killed before it is played again.

    A result that is another one would make DVC run all that follows from it, too.
    """
    seed = random.randrange(10**6)  # which stages, and a moment of its own in each
    rng = random.Random(seed)
    killed = finished.copied(tmp_path / "killed")
    killed.all_cores = True  # so that workers are killed, too, and results do not depend on them
    names = list(STAGES)
    chosen = [names[k] for k in sorted(rng.sample(range(len(names)), KILLED))]
    killed.forget(chosen)
    hit = [
        name
        for name in chosen
        if killed.kill_repro_at(name, rng.uniform(0, STAGES[name]), names[names.index(name) + 1 :])
    ]
    said = killed.repro()
    assert killed.metrics() == finished.metrics(), f"seed {seed}, killed in {hit}"
    assert (killed.root / "reports/index.html").stat().st_size > 1e6
    assert hit, f"seed {seed}: none of the stages still had something to do: {said}"
