"""After a run that does not come to its end, params.yaml and data/config are as before."""

import json
import os
import signal
import subprocess
import sys
import time
from functools import partial

import pytest

from spirob.cli.main import main
from spirob.cli.project import Kept, alone, read_overrides, write_overrides
from tests.cli.toy import toy
from tests.test_ending import alive


@pytest.fixture(scope="module", params=[False, True], ids=["plain", "persist"])
def project(request, tmp_path_factory):
    """Run to its end once, with DVC that deletes data/config before its stage and with one that
    does not."""
    root = toy(tmp_path_factory.mktemp("project"), request.param)
    assert run(root, "speed=3") == 0
    return root


def run(project, *arguments):
    return main(["run", *arguments, "--until", "report", "--project", str(project)])


def kept(project):
    files = [project / "params.yaml", *sorted((project / "data/config").iterdir())]
    return {path: path.read_bytes() for path in files}


@pytest.mark.parametrize(
    ("choice", "code"),
    [("config.bad=1", 2), ("diagnose.bad=1", 2), ("report.bad=1", 2), ("bug=1", 1)],
)
def test_whichever_stage_ends_it(project, capfd, choice, code):
    before = kept(project)
    assert run(project, choice, "speed=4") == code
    assert "the choices are taken back" in capfd.readouterr().err
    assert kept(project) == before
    assert run(project) == 0  # and what DVC has deleted comes back
    assert "choices are taken back" not in capfd.readouterr().err
    assert "speed=3" in (project / "data/diagnosis/choices").read_text()


def test_a_lock_of_dvc_that_is_busy(project, capfd):
    before = kept(project)
    owner = {"pid": os.getpid(), "cmd": "dvc repro"}
    busy = {str(project / "data/diagnosis"): owner}
    (project / ".dvc/tmp/rwlock").write_text(json.dumps({"read": {}, "write": busy}))
    assert run(project, "speed=5") == 2
    assert "busy" in capfd.readouterr().err
    assert kept(project) == before
    (project / ".dvc/tmp/rwlock").unlink()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_ends_all_of_it(project, number):
    before = kept(project)
    started = subprocess.Popen(
        [sys.executable, "-m", "spirob.cli.main", "run", "slow=1", "--until", "report"],
        cwd=project,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        preexec_fn=partial(heard, number),
    )
    stage = asleep(project)
    started.send_signal(number)
    assert started.wait(60) == 130
    assert "Traceback" not in started.stderr.read()
    assert ends(stage)
    assert kept(project) == before


def heard(number):
    """The signal is heard, and so is the one by which all is stopped: a test may run without it."""
    for one in (number, signal.SIGINT):
        signal.signal(one, signal.SIG_DFL)


def test_a_kill_leaves_no_stage_behind(project):
    started = subprocess.Popen(
        [sys.executable, "-m", "spirob.cli.main", "run", "slow=1", "--until", "report"],
        cwd=project,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    group = os.getpgid(asleep(project))  # DVC's and the stage's
    started.kill()
    started.wait()
    assert ends(-group)
    assert run(project, "speed=3") == 0


def asleep(project):
    """The number of the process of the stage that sleeps."""
    mark = project / "asleep"
    deadline = time.monotonic() + 60
    while not (mark.exists() and mark.read_text()) and time.monotonic() < deadline:
        time.sleep(0.05)
    number = int(mark.read_text())
    mark.unlink()
    return number


def ends(number):
    """Whether a process, or a group, is gone within a minute: the system takes it away, not we."""
    deadline = time.monotonic() + 60
    while alive(number) and time.monotonic() < deadline:
        time.sleep(0.05)
    return not alive(number)


def test_a_second_run_in_the_same_project_changes_nothing(project, capfd):
    before = kept(project)
    with alone(project):
        assert run(project, "speed=6") == 2
    assert "another `spirob`" in capfd.readouterr().err
    assert kept(project) == before


def test_choices_that_somebody_else_made_meanwhile_stay(project):
    before = kept(project)
    with Kept(project, ["speed=7"]):
        write_overrides(project, ["speed=8"])
    assert read_overrides(project) == ["speed=8"]
    with Kept(project, ["speed=9"]):
        write_overrides(project, ["speed=9"])
    assert read_overrides(project) == ["speed=8"]
    (project / "params.yaml").write_bytes(before[project / "params.yaml"])


LOCKED = """stages:
  config:
    cmd: {}
  diagnose:
    cmd: {}
"""


@pytest.mark.parametrize(("after", "back"), [(("new", "old"), True), (("new", "new"), False)])
def test_what_dvc_says_of_the_choices_goes_with_them_where_no_other_stage_ran(
    tmp_path, after, back
):
    (tmp_path / "params.yaml").write_text("overrides: []\n")
    lock = tmp_path / "dvc.lock"
    lock.write_text(LOCKED.format("old", "old"))
    with Kept(tmp_path, ["speed=7"]):
        write_overrides(tmp_path, ["speed=7"])
        lock.write_text(LOCKED.format(*after))
    assert read_overrides(tmp_path) == []
    assert (lock.read_text() == LOCKED.format("old", "old")) == back


def test_a_composed_configuration_that_was_not_there_goes(tmp_path):
    (tmp_path / "params.yaml").write_text("overrides: []\n")
    with Kept(tmp_path, None):
        (tmp_path / "data/config").mkdir(parents=True)
        (tmp_path / "data/config/config.yaml").write_text("half: 1\n")
    assert not list((tmp_path / "data/config").iterdir())
