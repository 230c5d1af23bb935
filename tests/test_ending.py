"""A program that is told to end cleans up and leaves nothing running."""

import signal
import subprocess
import sys

import psutil
import pytest

CHILD = """
import subprocess, sys, time
below = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
print(below.pid, flush=True)
time.sleep(600)
"""
PROGRAM = f"""
import subprocess, sys
from spirob.ending import ended_together, signals_raised
with signals_raised():
    try:
        command = [sys.executable, "-c", {CHILD!r}]
        child = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        with ended_together(child):
            print(child.pid, child.stdout.readline(), flush=True)
            child.wait()
    finally:
        print("cleaned", flush=True)
"""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_to_end_reaches_all_that_was_started(number):
    program = subprocess.Popen([sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, text=True)
    assert program.stdout is not None
    started = [psutil.Process(int(pid)) for pid in program.stdout.readline().split()]
    assert len(started) == 2
    program.send_signal(number)
    rest = program.stdout.read()
    assert program.wait() == 128 + number
    assert "cleaned" in rest
    assert psutil.wait_procs(started, timeout=60)[1] == []
