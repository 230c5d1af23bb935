"""A log can say what made it, also where there is no git."""

import platform

import spirob
from spirob.logs.writer import git_commit, versions


def test_versions_name_what_decides_the_numbers():
    found = versions()
    assert found["python"] == platform.python_version()
    assert found["spirob"] == spirob.__version__
    assert {"numpy", "mujoco"} <= set(found)


def test_no_work_tree_has_no_commit(tmp_path):
    assert git_commit(tmp_path) == "unknown"
    assert git_commit(tmp_path / "absent") == "unknown"
