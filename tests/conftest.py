"""Property tests draw the same examples in every run; HYPOTHESIS_PROFILE=drawn draws others.

How long an example takes says how busy the machine is, and fails no test.

Files are handed out in their order, the costly ones first: a worker that begins one last is waited
for.  Workers are as many as cores, so none of them, and no process that it starts, takes a second
core for its linear algebra.  What is compiled of Python stays, as what Numba compiles does: each of
these processes would compile it again.  Where files are read apart, the process from which those
are forked has loaded what files of effects need, too, whichever is read first.
"""

import os
import sys

from hypothesis import settings

for library in ("OMP", "OPENBLAS", "MKL"):  # each reads it once, as NumPy or SciPy is imported
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

settings.register_profile("same", derandomize=True, database=None, deadline=None)
settings.register_profile("drawn", deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))

COSTLY = (  # the costliest first; where one moves, the order is worth a little less, no test is
    "pipeline/test_whole_way.py",
    "machine/test_verdicts.py",
    "diagnosis/test_arm_search.py",
    "machine/test_what_logs_hold.py",
    "docs/test_docs.py",
    "machine/forward/test_identity.py",  # where nothing is compiled yet
    "emulator/test_hidden.py",
    "campaign/test_cases.py",
    "machine/arm/test_preparation.py",
    "machine/test_diagnosis.py",
    "diagnosis/test_fitting.py",
    "benchmark/test_benchmark.py",
    "machine/composed/test_doubted.py",
    "pipeline/test_bad_input.py",
    "cli/test_interruption.py",
    "machine/test_numbers.py",
    "diagnosis/test_contest.py",
    "campaign/arm/test_running.py",
    "pipeline/test_recorded.py",
    "machine/test_damaged_logs.py",
    "machine/composed/test_arm.py",
    "machine/test_effort_by_itself.py",
    "tests/test_ending.py",  # which waits more than it works, and would be the last
)


def pytest_sessionstart():
    from spirob.logs import readers  # loads NumPy

    readers.ALWAYS = (*readers.ALWAYS, "spirob.machine.loading")


def pytest_collection_modifyitems(items):
    """Begin with the costly files."""

    def place(item):
        path = item.path.as_posix()
        return next((k for k, one in enumerate(COSTLY) if path.endswith(one)), len(COSTLY))

    items.sort(key=place)
