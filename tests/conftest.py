"""Property tests draw the same examples in every run; HYPOTHESIS_PROFILE=drawn draws others.

How long an example takes says how busy the machine is, and fails no test.

Files are handed out in their order, the costly ones first: a worker that begins one last is waited
for.
"""

import os

from hypothesis import settings

settings.register_profile("same", derandomize=True, database=None, deadline=None)
settings.register_profile("drawn", deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))

COSTLY = (  # the costliest first; where one moves, the order is worth a little less, no test is
    "pipeline/test_whole_way.py",
    "machine/test_verdicts.py",
    "diagnosis/test_arm_search.py",
    "machine/test_what_logs_hold.py",
    "emulator/test_hidden.py",
    "machine/arm/test_preparation.py",
    "campaign/test_cases.py",
    "diagnosis/test_fitting.py",
    "cli/test_interruption.py",
    "benchmark/test_benchmark.py",
    "docs/test_docs.py",
    "pipeline/test_bad_input.py",
    "machine/composed/test_arm.py",
    "machine/test_diagnosis.py",
    "campaign/arm/test_running.py",
    "pipeline/test_recorded.py",
    "diagnosis/test_contest.py",
    "machine/test_damaged_logs.py",
    "machine/test_damaged_diagnoses.py",
)


def pytest_collection_modifyitems(items):
    """Begin with the costly files."""

    def place(item):
        path = item.path.as_posix()
        return next((k for k, one in enumerate(COSTLY) if path.endswith(one)), len(COSTLY))

    items.sort(key=place)
