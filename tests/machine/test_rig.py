"""The description of a rig: strict, and every mistake says where it stands."""

import pytest
import yaml

from spirob.errors import ConfigError, MissingLog
from spirob.machine.loading import load_rig
from tests.machine.rigs import description


def written(tmp_path, content):
    path = tmp_path / "rig.yaml"
    path.write_text(content if isinstance(content, str) else yaml.safe_dump(content))
    return path


def test_a_description_is_read(tmp_path):
    rig, folder = load_rig(written(tmp_path, description()))
    assert rig.fit["viscous"].high == 5.0
    assert folder == tmp_path


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"colour": "red"}, "colour: no such key"),
        ({"fit": {"mass": {"nominal": 1, "low": 0, "high": 2}}}, "no number 'mass'"),
        ({"fit": {"inertia": {"nominal": 3, "low": 0, "high": 2}}}, "fit.inertia: needs low"),
        ({"known": {"viscous": 1.0}}, "viscous: either known or fitted"),
        ({"position": {"column": "q", "unit": "inch"}}, "position.unit 'inch'"),
        ({"effort": {"column": "u", "unit": "A", "kind": "torque"}}, "'A' is no torque"),
        ({"effort": {"column": "u", "unit": "A", "kind": "power"}}, "effort.kind"),
        ({"velocity": {"column": "v", "unit": "rpx"}}, "velocity.unit 'rpx'"),
        ({"velocity": {"column": "v", "unit": "mm/s"}}, "does not go with an axis in rad"),
        ({"position": {"column": "q", "unit": "tick"}}, "ticks need per_turn"),
        ({"effort": {"column": "u", "unit": "%", "kind": "duty"}}, "a duty needs its supply"),
        ({"effort": {"unit": "A", "kind": "current"}}, "give either its column, or from: control"),
        ({"known": {"back_emf": 0.1}}, "only where the effort is a voltage"),
        ({"control": {"kp": 1.0, "position": 2.0, "velocity": 1.0}}, "cascade, or kp"),
        ({"predict": "closed_loop"}, "needs 'control' and 'reference'"),
        ({"body": {"mjcf": "a.xml"}}, "driven joint or the driven tendon"),
        ({"time": {"column": "t", "unit": "s", "factor": 0}}, "a factor of 0"),
    ],
)
def test_a_mistake_is_a_sentence_with_its_place(tmp_path, change, sentence):
    with pytest.raises(ConfigError, match=sentence):
        load_rig(written(tmp_path, description(**change)))


@pytest.mark.parametrize("text", ["[1, 2]", "a: b: c", "!!python/object:os.system {}", "\0"])
def test_what_is_no_description_is_refused(tmp_path, text):
    with pytest.raises(ConfigError):
        load_rig(written(tmp_path, text))


def test_an_absent_description_is_said(tmp_path):
    with pytest.raises(MissingLog, match="no such rig"):
        load_rig(tmp_path / "nowhere.yaml")
