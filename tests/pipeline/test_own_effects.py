"""Files of effects: what the configuration was checked with is what every stage loads."""

from pathlib import Path

import pytest

from pipeline.config import composed, write
from pipeline.model import fitted_names, plant, start
from pipeline.own_effects import COPIES, given, lay_beside
from pipeline.schema import validated
from pipeline.stage import PUBLIC, read_yaml
from spirob.effects import find_effects

ROOT = Path(__file__).parents[2]
TEMPLATE = ROOT / "spirob/effects/template.py.txt"


@pytest.fixture
def project(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.py").write_text(TEMPLATE.read_text())
    return tmp_path


def configured(project, *overrides):
    write(project, composed(ROOT, list(overrides)), "conf")
    return validated(read_yaml(project / PUBLIC, "config"), "conf")


def test_a_file_stays_as_it_was_when_the_configuration_was_checked(project):
    before = configured(project, "plant.effects=[creep, own.py]").plant.effects
    assert before[0] == "creep"
    assert Path(before[1]).is_relative_to(COPIES)
    (project / "own.py").unlink()
    assert [e.name() for e in find_effects(before)] == ["creep", "own"]


def test_a_changed_file_is_another_configuration(project):
    first = configured(project, "plant.effects=[own.py]").plant.effects
    assert configured(project, "plant.effects=[own.py]").plant.effects == first
    (project / "own.py").write_text(TEMPLATE.read_text() + "\n# changed\n")
    assert configured(project, "plant.effects=[own.py]").plant.effects != first


def test_a_model_holds_an_effect_once_however_often_it_is_named(project):
    config = configured(project, "plant.effects=[own.py]")
    model = plant(config, find_effects(config.plant.effects))
    assert [e.name() for e in model.effects] == ["own"]


def test_numbers_that_are_held_begin_at_nominal_and_are_not_fitted(project):
    text = TEMPLATE.read_text()
    (effect,) = find_effects(["own.py"])
    held = next(f for f in effect.parameters() if f not in effect.neutral)
    (project / "own.py").write_text(
        text.replace("    neutral =", f"    held = {{{held!r}}}\n    neutral =")
    )
    config = configured(project, "plant.effects=[own.py]")
    assert f"own.{held}" in start(config)
    assert f"own.{held}" not in fitted_names(config)


def test_names_are_found_again_as_the_configuration_gives_them(project):
    config = configured(project, "diagnose.candidates=[own.py, creep]")
    (path, _) = config.diagnose.candidates
    assert given(config, ["creep", "own"]) == ["creep", path]


def test_the_files_of_a_model_lie_beside_it(project):
    config = configured(project, "plant.effects=[own.py]")
    (project / "out").mkdir()
    lay_beside(project, config, Path("out"))
    assert (project / "out/own.py").read_text() == (project / "own.py").read_text()
