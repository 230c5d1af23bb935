"""A kill in the moment in which DVC writes its own files stops no further run."""

import json
from contextlib import suppress

import pytest
from dvc.exceptions import DvcException
from dvc.repo import Repo

from spirob.cli.project import discard_torn


@pytest.fixture
def project(tmp_path):
    (tmp_path / ".dvc/tmp").mkdir(parents=True)
    (tmp_path / ".dvc/tmp/rwlock").write_text('{"read": {}, "write": {}}')
    (tmp_path / "dvc.lock").write_text("schema: '2.0'\nstages:\n  a:\n    cmd: b\n")
    return tmp_path


@pytest.mark.parametrize(
    ("name", "cuts"), [(".dvc/tmp/rwlock", (0, 1, 12, 24)), ("dvc.lock", (0, 5, 10))]
)
def test_a_torn_file_goes_and_the_other_stays(project, name, cuts):
    whole = (project / name).read_text()
    for cut in cuts:
        (project / name).write_text(whole[:cut])
        assert discard_torn(project) == [name]
        assert not (project / name).exists()
    kept = {".dvc/tmp/rwlock", "dvc.lock"} - {name}
    assert all((project / other).exists() for other in kept)


@pytest.mark.parametrize(
    "entry",
    [
        ("path: a", "hash: md5", "md5: 0cc175b9c0f1b6a831c399e269772661", "size: 1"),
        ("hash: md5", "md5: 0cc175b9c0f1b6a831c399e269772661", "size: 1", "path: a"),
    ],
    ids=["path first", "path last"],
)
def test_wherever_its_lock_is_cut_dvc_runs_again(tmp_path, monkeypatch, entry):
    """Cut after `size:` it is still YAML, which DVC refuses; what is left must be what it takes."""
    monkeypatch.setattr("spirob.cli.project.ROUND", 0.0)  # nobody is writing it
    Repo.init(str(tmp_path), no_scm=True).close()
    (tmp_path / "a").write_text("a")
    (tmp_path / "dvc.yaml").write_text(
        "stages:\n  b:\n    cmd: echo b > b\n    deps: [a]\n    outs: [b]\n"
    )
    whole = "schema: '2.0'\nstages:\n  b:\n    cmd: echo b > b\n    deps:\n    - "
    whole += "\n      ".join(entry) + "\n"
    refused = 0
    with Repo(str(tmp_path)) as repo:  # it reads its files anew at every question
        for cut in range(len(whole)):
            (tmp_path / "dvc.lock").write_text(whole[:cut])
            with suppress(DvcException, NotImplementedError):
                repo.status()
                continue
            refused += 1
            discard_torn(tmp_path)
            repo.status()
    assert refused > 20


def test_whole_files_and_missing_ones_are_left_alone(project, tmp_path_factory):
    assert discard_torn(project) == []
    assert json.loads((project / ".dvc/tmp/rwlock").read_text()) == {"read": {}, "write": {}}
    assert discard_torn(tmp_path_factory.mktemp("empty")) == []
