"""`spirob run` on a pipeline of three tiny stages, with DVC itself."""

import json
import os
import signal
import subprocess
import sys
import time
from functools import partial

import pytest

from spirob.cli.main import main
from spirob.cli.project import read_overrides
from spirob.cli.reproduce import TIMES, stages
from tests.cli.toy import toy


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    return toy(tmp_path_factory.mktemp("project"))


def run(project, *arguments):
    return main(["run", *arguments, "--project", str(project)])


def test_a_run_says_the_verdict_and_every_stage_and_a_second_has_nothing_to_do(project, capfd):
    assert run(project, "speed=3", "--until", "report") == 0
    out, err = capfd.readouterr()
    assert out.splitlines() == [
        "Nothing is missing.",
        f"report: {project / 'reports/index.html'}",
        "these choices stay in params.yaml; the way back: spirob run --defaults",
    ]
    assert [line.split(":")[0] for line in err.splitlines()] == ["config", "diagnose", "report"]
    assert read_overrides(project) == ["speed=3"]
    assert set(json.loads((project / TIMES).read_text())) == {"config", "diagnose", "report"}
    assert run(project, "--until", "report") == 0
    assert capfd.readouterr().err.count("unchanged") == 3


def test_earlier_choices_that_new_ones_replace_are_named(project, capfd):
    def said(*choices):
        assert run(project, *choices, "--until", "config") == 0
        told = [line for line in capfd.readouterr().err.splitlines() if "earlier" in line]
        return told[0].split("; ")[0] if told else ""

    said("--defaults")
    assert said("speed=3", "other=1") == ""
    assert said("speed=4") == "earlier choices are replaced: other=1"
    assert said("speed=5") == "", "its own key is named"
    assert said("--defaults", "other=2") == "", "asked for"
    assert said() == "", "none is made"
    assert said("speed=6") == "earlier choices are replaced: other=2"
    assert run(project, "speed=3", "--until", "report") == 0


def test_a_refused_choice_is_one_sentence_and_is_taken_back(project, capfd):
    before = read_overrides(project)
    assert run(project, "config.bad=1", "--until", "report") == 2
    _, err = capfd.readouterr()
    assert "config: bad may not be 1" in err
    assert "Traceback" not in err
    assert "ERROR" not in err
    assert read_overrides(project) == before


def test_a_bug_shows_its_traceback_and_is_code_1(project, capfd):
    assert run(project, "bug=1", "--until", "report") == 1
    assert "ZeroDivisionError" in capfd.readouterr().err


def test_stopping_by_hand_is_130_and_the_next_run_goes_on(project, capfd):
    started = subprocess.Popen(
        [sys.executable, "-m", "spirob.cli.main", "run", "slow=1", "--until", "report"],
        cwd=project,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        # what a shell puts in the background ignores an interruption, and so would its children
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )
    deadline = time.monotonic() + 30
    while not (project / "asleep").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    os.killpg(started.pid, signal.SIGINT)
    assert started.wait(60) == 130  # 20 s were once too few on a busy machine
    assert "Traceback" not in started.stderr.read()
    assert run(project, "--defaults", "--until", "report") == 0
    assert read_overrides(project) == []


def test_verbose_lets_the_stages_speak(project, capfd):
    assert run(project, "loud=1", "--until", "config", "--verbose") == 0
    assert "config speaks" in capfd.readouterr().err


def test_a_stage_that_is_none_changes_nothing(project, capfd):
    assert run(project, "a=1", "--until", "magic") == 2
    assert "no stage 'magic'" in capfd.readouterr().err
    assert read_overrides(project) != ["a=1"]


def test_the_stages_up_to_a_target_leave_out_what_it_does_not_need(project):
    assert stages(project, "report") == ["config", "diagnose", "report"]
    assert stages(project) == ["config", "diagnose", "report", "aside"]
