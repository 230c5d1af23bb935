"""No process outlives the one that started it, however that one ends."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from spirob.ending import stop_as_by_hand

PATIENCE = 60.0  # s, for a busy machine; what is waited for takes one or two
NOTE = """
import os, pathlib, sys, time
folder = pathlib.Path(sys.argv[-1])
def sleeper(*given):
    part = folder / f".{os.getpid()}"
    part.touch()
    part.rename(folder / str(os.getpid()))
    time.sleep(1000)
"""
PARENTS = {
    "a pool": """
        from joblib import Parallel, delayed
        from spirob.ending import end_with_parent
        Parallel(n_jobs=2, initializer=end_with_parent)(delayed(sleeper)() for _ in range(2))
    """,
    "a trial": """
        from spirob.campaign.arm import running
        from spirob.campaign.arm.case import Case
        running._one = sleeper
        running.play([Case("none", 0), Case("none", 1)], folder / "cases.jsonl", 2)
    """,
    "a stage": """
        import subprocess
        from pipeline import robots
        from pipeline.schema import Config, Emulated
        robots._record = sleeper
        config = Config.model_construct(robot=Emulated(kind="emulated"))
        robots.workers = lambda: 2
        robots.record_all(folder, config, {}, [{}, {}])
    """,
    "a module": """
        import subprocess
        (folder / "asleep.py").write_text(NOTE + "sleeper()")
        os.environ["PYTHONPATH"] += os.pathsep + str(folder)
        for _ in range(2):
            subprocess.Popen([sys.executable, "-m", "spirob.ending", "asleep", str(folder)])
        time.sleep(1000)
    """,
    "readers": """
        import threading
        (folder / "asleep.py").write_text(NOTE)
        sys.path.append(str(folder))
        import asleep
        from spirob.logs.readers import apart
        for _ in range(2):
            threading.Thread(target=apart, args=(asleep.sleeper, str(folder))).start()
    """,
}


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
@pytest.mark.parametrize("parent", PARENTS)
def test_those_it_started_end_with_it(tmp_path, parent, number):
    code = f"NOTE = {NOTE!r}\n{NOTE}\n{textwrap.dedent(PARENTS[parent])}"
    started = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    children = waited(lambda: noted(tmp_path)[1:] and noted(tmp_path))
    started.send_signal(number)
    started.wait(PATIENCE)
    waited(lambda: not any(runs(child) for child in children))


def noted(folder):
    return [int(path.name) for path in folder.iterdir() if path.name.isdigit()]


def alive(number):
    """Whether a process is there, or of a negative number, any of that group."""
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    return True


def runs(number):
    """Whether a process has not ended, which is there until the system takes it away."""
    try:
        told = Path(f"/proc/{number}/stat").read_text()
    except OSError:  # gone, or Linux is not here
        return alive(number)
    return told.rpartition(") ")[2][0] not in "ZX"


def waited(sought):
    deadline = time.monotonic() + PATIENCE
    while not (found := sought()):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    return found


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_is_raised_as_by_hand(number):
    before = signal.signal(number, signal.SIG_DFL)
    try:
        stop_as_by_hand()
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), number)
    finally:
        signal.signal(number, before)


def test_a_signal_that_is_ignored_stays_so():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        stop_as_by_hand()
        os.kill(os.getpid(), signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)
