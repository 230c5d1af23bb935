"""The project's folder and its params.yaml: only the choices change, and only good ones."""

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.cli.project import find_project, read_overrides, spelt_out, write_overrides
from spirob.errors import ConfigError
from tests.pipeline.project import SHORT, SOURCE

HEAD = "# Hydra overrides, one string each, e.g. ['robot.hidden.effect=joint_creep'].\n"


def project(folder, params="overrides: []\n"):
    (folder / "pipeline").mkdir(exist_ok=True)
    (folder / "dvc.yaml").write_text("stages: {}\n")
    (folder / "params.yaml").write_text(HEAD + params)
    return folder


def test_it_is_found_from_a_folder_inside(tmp_path, monkeypatch):
    project(tmp_path)
    (tmp_path / "data/raw").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "data/raw")
    assert find_project(None) == tmp_path.resolve()


def test_where_there_is_none_the_sentence_says_what_belongs_to_one(tmp_path):
    with pytest.raises(ConfigError, match=r"dvc\.yaml"):
        find_project(str(tmp_path))


@pytest.mark.parametrize(
    "params",
    [
        "overrides: []\n",
        "overrides: [a=1, 'b=[2, 3]']\n",
        "overrides:\n  - a=1\n  - b=2\n",
        "overrides:\n- a=1\n- b=2\n",
        "",
    ],
)
def test_only_the_choices_change(tmp_path, params):
    project(tmp_path, params + "other: kept # and its comment\n")
    write_overrides(tmp_path, ["c=3", "plant.effects=[capstan_friction]"])
    text = (tmp_path / "params.yaml").read_text()
    assert text.startswith(HEAD)
    assert "other: kept # and its comment\n" in text
    assert yaml.safe_load(text)["overrides"] == ["c=3", "plant.effects=[capstan_friction]"]


@settings(deadline=None, max_examples=50)  # each writes to disk and waits for it
@given(st.lists(st.text(st.characters(blacklist_categories=("Cs", "Cc")), max_size=30), max_size=4))
def test_whatever_a_value_holds_is_read_back(tmp_path_factory, values):
    folder = project(tmp_path_factory.mktemp("project"))
    chosen = [f"key{k}={value}" for k, value in enumerate(values)]
    write_overrides(folder, chosen)
    assert read_overrides(folder) == chosen


@pytest.mark.parametrize("item", ["nonsense", "=3", "a b=3", ""])
def test_what_is_no_choice_is_refused(tmp_path, item):
    project(tmp_path)
    with pytest.raises(ConfigError, match="KEY=VALUE"):
        write_overrides(tmp_path, [item])
    assert read_overrides(tmp_path) == []


def test_a_preset_is_chosen_in_every_group_that_has_it(tmp_path):
    for name in ("b/short", "a/short", "a/long"):
        (tmp_path / f"conf/{name}.yaml").parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / f"conf/{name}.yaml").touch()
    assert spelt_out(tmp_path, ["short", "c=short", "~d"]) == [
        "a=short",
        "b=short",
        "c=short",
        "~d",
    ]
    assert spelt_out(tmp_path, ["none", "../a/long", "*"]) == ["none", "../a/long", "*"]


def test_short_is_all_that_a_short_run_needs():
    assert sorted(spelt_out(SOURCE, ["short"])) == sorted(SHORT)


@pytest.mark.parametrize("params", ["overrides: [", "overrides: robot=can\n"])
def test_broken_params_are_said(tmp_path, params):
    project(tmp_path, params)
    with pytest.raises(ConfigError, match=r"params\.yaml"):
        read_overrides(tmp_path)
