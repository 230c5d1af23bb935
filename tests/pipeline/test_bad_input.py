"""A user's mistake is one sentence that names the file and the key, and nothing is half-written."""

import os
import subprocess
import sys
from dataclasses import replace
from functools import cache
from importlib import import_module

import numpy as np
import pytest
from hydra import compose as hydra_compose

from pipeline import config
from pipeline.stage import public_config, run, write_json
from spirob.logs import read_parquet, write_parquet
from spirob.logs.trace import Trace
from spirob.machine import loading
from spirob.plant import Plant, Rig
from spirob.trials import Trial
from spirob.trials.simulation import simulate
from tests.effects.test_declaration import GOOD
from tests.pipeline.project import SHORT, SOURCE


class Folder:
    """A project folder in which stages run in this process."""

    def __init__(self, root, monkeypatch, capfd):
        self.root, self.capfd = root, capfd
        (root / "conf").symlink_to(SOURCE / "conf")
        self.override(SHORT)
        monkeypatch.chdir(root)

    def override(self, overrides):
        (self.root / "params.yaml").write_text(f"overrides: {overrides!r}\n")

    def refused(self, name):
        """What a stage says when it refuses: one sentence, code 2."""
        self.capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            run(name, import_module(f"pipeline.{name}").stage)
        assert ended.value.code == 2
        spoken = self.capfd.readouterr().err
        assert len(spoken.strip().splitlines()) == 1
        return spoken


@cache
def answer(name, overrides):
    """What Hydra makes of overrides, or why it refuses them: the same each time, and slow."""
    try:
        return hydra_compose(name, list(overrides)), None
    except config.REFUSED as refused:
        return None, refused


def compose(name, overrides):
    """As that of Hydra, with one answer for all tests that ask the same."""
    made, refused = answer(name, tuple(overrides))
    if refused:
        raise refused
    return made


@pytest.fixture
def project(tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(config, "compose", compose)
    return Folder(tmp_path, monkeypatch, capfd)


@pytest.fixture
def configured(project):
    run("config", config.stage)
    return project


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("identify.cutof=3", "cutof"),
        ("identify.filter.cutoff=1000", "identify.filter.cutoff"),
        ("identify.parameters=[motor.mass]", "no parameter 'motor.mass'"),
        ("rig.winch.radius=-1", "winch.radius"),
        ("+rig.wings=2", "rig has no part 'wings'"),
        ("robot=marvin", "marvin"),
        ("robot.hidden.strength=high", "robot.hidden.strength"),
        ("plant.effects=[magic]", "no effect 'magic'"),
        ("diagnose.candidates=[magic]", "no effect 'magic'"),
        ("recordings.trials.0.duration=-1", "duration"),
        ("recordings.trials.0.motors.left.mode=fly", "fly"),
        ("perceive.repeats=0", "perceive.repeats"),
        ("rig.name=x y z=", "rig.name"),
        ("+rig.units=0", "units"),
        ("+rig.drive.loop=bus", "rig: drive.loop is drive or host, not 'bus'"),
        ("+rig.drive={loop: host, host: {bandwidth: 200}}", "the largest bandwidth is 110.3 Hz"),
        ("+rig.drive={loop: host, host: {proportional: 2}}", "that are stable: K_p = 0."),
        # what later stages would refuse, after the robot has played for a minute
        ("robot.hidden.effect=coging", "robot.hidden.effect: no hidden effect 'coging'; known: "),
        ("robot.hidden.effect=cogging:50", "robot.hidden.effect: hidden effect: strength = 50"),
        ("robot.faults=[{kind: gone}]", "robot.faults: no fault 'gone'"),
        ("+robot.safety.speed=-1", "robot.safety: safety.speed = -1"),
        ("+robot.safety.sped=1", "safety has no number 'sped'; it has: current, slew"),
        ("+rig.winch.radius=0.11", "winch_radius = 0.11"),
        ("plant.effects=[cogging,cogging]", "plant.effects: 'cogging' stands twice"),
        ("diagnose.candidates=[cogging,cogging]", "diagnose.candidates: 'cogging' stands twice"),
        ("identify.parameters=[motor.rotor_inertia,motor.rotor_inertia]", "stands twice"),
        ("recordings.trials.1.name=train_left", "'train_left' stands twice"),
        ("recordings.trials.0.duration=0.05", "trial 'train_left': 50 ms"),
        ("perceive.diameters=[0.02,0.02,0.02]", "perceive.diameters"),
        ("perceive.unseen=[-0.1]", "diameter must be above 0"),
        ("trial.kinds=[magic]", "trial.kinds: trial: no kind 'magic'"),
        ("trial.seeds=[3,1]", "trial.seeds"),
    ],
)
def test_a_bad_configuration(project, override, said):
    project.override([*SHORT, override])
    assert said in project.refused("config")
    assert not (project.root / "data/config").exists()


def test_no_trial_to_fit(project):
    project.override([*SHORT, *(f"recordings.trials.{k}.role=heldout" for k in (0, 1))])
    assert "no trial has the role 'train'" in project.refused("config")


@pytest.mark.parametrize("key", ["plant.effects", "diagnose.candidates", "robot.effects"])
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("import sys\nsys.exit(0)", "fails: SystemExit: 0"),
        ("while True:\n    pass", "does not end"),
        (GOOD.replace("return -torque", "raise ValueError(torque)"), "kernel fails"),
    ],
)
def test_a_file_of_an_effect_that_fails_is_a_sentence(project, monkeypatch, key, text, said):
    monkeypatch.setattr(loading, "LONGEST", 1.0 if "while" in text else 3.0)
    robot = ["robot=simulated"] if key == "robot.effects" else []
    (project.root / "own.py").write_text(text)
    project.override([*SHORT, *robot, f"{key}=[own.py]"])
    spoken = project.refused("config")
    assert said in spoken
    assert key in spoken


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (["robot=simulated", "robot.effects=[magic]"], "robot.effects: no effect 'magic'"),
        (["robot=simulated", "+robot.changes.motor=1"], "robot.changes: no parameter 'motor'"),
        (["robot=can", "robot.interface=smoke"], "no interface 'smoke'"),
        (["robot=can", "robot.drive=nothing"], "no drive 'nothing'"),
        (["robot=can", "rig=spirob_direct_host"], "drive 'c620' has no voltage mode"),
        (["robot=can", "robot.drive=gm6020"], "'gm6020' takes voltages"),
        (
            ["robot=can", "rig=spirob_direct_host", "robot.drive=gm6020", "robot.bitrate=250000"],
            "a bus of 250 kbit/s is slower than the loop",
        ),
        (["identify.filter.kind=moving_average", "identify.filter.window=9000"], "needs at least"),
    ],
)
def test_a_bad_configuration_of_several(project, overrides, said):
    project.override([*SHORT, *overrides])
    assert said in project.refused("config")


@pytest.mark.parametrize(
    ("override", "said"),
    [
        (
            "plnat.effects=[]",
            "'plnat.effects=[]': conf/ lists no 'plnat.effects'; nearest: plant.eff",
        ),
        ("robot.hiden.effect=none", "nearest: robot.hidden.effect"),
        ("robott=can", "nearest: robot,"),
        ("robot=cann", "'robot=cann': In 'config': Could not find 'robot/cann' Available options"),
        ("plant.effects=[cogging", "'plant.effects=[cogging': "),
        ("rig.winch.radius=0.03", "only the code knows is added: '+rig.winch.radius=0.03'"),
        ("+robot.interface=x", "key 'robot.interface': Extra inputs are not permitted; known here"),
        ("~robot.hiden", "nearest: robot.hidden"),
    ],
)
def test_an_override_at_fault_is_named_with_the_nearest_keys(project, override, said):
    for overrides in ([*SHORT, override], [override, *SHORT], [override]):
        project.override(overrides)
        spoken = project.refused("config")
        assert said in spoken
        assert "trial=short" not in spoken


def test_a_refused_configuration_leaves_the_last_one(configured):
    folder = configured.root / "data/config"
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    configured.override([*SHORT, "robot.hidden.effect=coging"])
    configured.refused("config")
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_overrides_that_are_no_list(project):
    (project.root / "params.yaml").write_text("overrides: robot=can\n")
    assert "'overrides' must be a list" in project.refused("config")


def test_a_params_file_that_is_not_yaml(project):
    (project.root / "params.yaml").write_text("overrides: [")
    assert "params.yaml is not YAML" in project.refused("config")


@pytest.mark.parametrize("stage", ["decode", "identify", "compare", "diagnose", "train", "report"])
def test_a_stage_before_its_turn_names_what_is_missing(configured, stage):
    spoken = configured.refused(stage)
    assert "data/" in spoken
    assert "stage" in spoken


def test_hardware_without_recorded_logs(project):
    project.override([*SHORT, "robot=can"])
    run("config", config.stage)
    assert "train_left.mcap is missing" in project.refused("collect")


def trace(length: int) -> Trace:
    time = np.arange(length, dtype=np.int64) * 1_000_000
    signals = {f"left.{name}": np.zeros(length) for name in ("current", "displacement")}
    return Trace("train_left", time, signals, dict.fromkeys(signals, ""), {})


def test_a_log_without_a_channel(configured):
    write_parquet(trace(400), configured.root / "data/traces/train_left.parquet")
    spoken = configured.refused("identify")
    assert "train_left" in spoken
    assert "channel 'right.current' is missing" in spoken or "channel 'left.velocity'" in spoken


def test_a_trial_shorter_than_the_filter(configured):
    path = configured.root / "data/traces/train_left.parquet"
    write_parquet(trace(50), path)
    assert len(read_parquet(path)) == 50
    spoken = configured.refused("identify")
    assert "train_left: 50 samples" in spoken


def test_a_damaged_trace(configured):
    path = configured.root / "data/traces/train_left.parquet"
    path.parent.mkdir(parents=True)
    path.write_bytes(b"PAR1 nothing")
    spoken = configured.refused("identify")
    assert "train_left.parquet" in spoken


def exchanged(trace: Trace) -> Trace:
    """The trace with each motor's current in the other's column."""
    other = {"left.current": "right.current", "right.current": "left.current"}
    signals = {name: trace.signals[other.get(name, name)] for name in trace.signals}
    return replace(trace, signals=signals)


@pytest.mark.parametrize(
    ("role", "stage"),
    [("train", "identify"), ("validate", "diagnose"), ("heldout", "diagnose")],
)
def test_two_motors_exchanged(project, role, stage):
    """Though all numbers that are fitted together explain half of exchanged currents."""
    project.override(SHORT)
    run("config", config.stage)
    told = public_config(project.root)
    plant = Plant(Rig.from_mapping(told.rig))
    for k, plain in enumerate(told.recordings.trials):
        log = simulate(plant, Trial.from_plain(plain), {}, 0.005, seed=k)
        log = exchanged(log) if log.meta["role"] == role else log
        write_parquet(log, project.root / f"data/traces/{log.name}.parquet")
    fitted = {"changes": {}, "gate": {"silent": [], "held": []}}
    write_json(project.root / "data/identified/base.json", fitted)
    spoken = project.refused(stage)
    assert "explains 0% of the current's variance" in spoken
    assert f"least in {role}_" in spoken
    assert "are the columns of the two motors exchanged" in spoken


def test_the_process_says_one_sentence_and_no_traceback(tmp_path):
    command = [sys.executable, "-m", "pipeline.decode"]
    env = {**os.environ, "PYTHONPATH": str(SOURCE)}
    done = subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith("decode: data/raw holds no log")
    assert "Traceback" not in done.stderr
