"""Where the page comes from: the commit, what differs from it, data, versions, the command."""

import subprocess

import pytest

from spirob.report.provenance import PACKAGES, collect

CONFIG = "perceive:\n  seed: 4\n"


@pytest.fixture
def project(tmp_path):
    (tmp_path / "conf").mkdir()
    (tmp_path / "conf/config.yaml").write_text(CONFIG)
    (tmp_path / "params.yaml").write_text("overrides: []\n")
    (tmp_path / "data").mkdir()
    (tmp_path / "data/table").write_text("1")
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", "conf", "params.yaml")
    git(tmp_path, "-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "first")
    return tmp_path


def git(root, *words):
    return subprocess.run(["git", *words], cwd=root, check=True, capture_output=True, text=True)


def test_a_clean_tree_is_its_commit(project):
    found = collect(project, ["data/table"], CONFIG)
    assert found.commit == git(project, "rev-parse", "HEAD").stdout.strip()
    assert found.dirty is False
    assert found.command == "spirob run --defaults"
    assert found.seed == "perceive.seed = 4"


def test_what_differs_is_named_and_data_do_not_count(project):
    (project / "conf/config.yaml").write_text("perceive:\n  seed: 5\n")
    (project / "conf/new.yaml").write_text("a: 1\n")
    (project / "data/table").write_text("2")
    found = collect(project, ["data/table"], CONFIG)
    assert found.dirty is True
    assert found.changed == ("conf/config.yaml", "conf/new.yaml")


def test_the_command_holds_the_choices(project):
    (project / "params.yaml").write_text(
        "overrides: [rig=spirob, 'plant.effects=[creep, stretch]']"
    )
    command = collect(project, [], CONFIG).command
    assert command == "spirob run rig=spirob 'plant.effects=[creep, stretch]'"


def test_a_hash_follows_the_content_of_a_file_and_of_a_folder(project):
    def hashes():
        return collect(project, ["data/table", "data"], CONFIG).hashes

    before = hashes()
    (project / "data/table").write_text("2")
    after = hashes()
    assert before["data/table"] != after["data/table"]
    assert before["data"] != after["data"]
    assert hashes() == after


def test_without_a_repository_nothing_is_claimed(tmp_path):
    found = collect(tmp_path, [], CONFIG)
    assert found.commit == "unknown"
    assert found.dirty is None


def test_all_versions_are_known(project):
    versions = collect(project, [], CONFIG).versions
    assert {"python", "spirob", "numpy", "mujoco", "platform", *PACKAGES} <= set(versions)
    assert "absent" not in versions.values()
