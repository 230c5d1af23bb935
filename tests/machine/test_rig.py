"""The description of a rig: strict, and every mistake says where it stands."""

import copy

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from spirob.errors import ConfigError, DataError, MissingLog
from spirob.machine.arm.description import ArmFile
from spirob.machine.description.rig import RigFile
from spirob.machine.loading import described, load_rig
from tests.machine.arm import elsewhere
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
        ({"effort": {"column": "u", "unit": "%", "kind": "duty"}}, "a duty needs effort.supply: "),
        (
            {"effort": {"column": "u", "unit": "A", "kind": "current", "supply": 12.0}},
            "effort.supply is that of a duty; a current has none",
        ),
        ({"effort": {"unit": "A", "kind": "current"}}, "give either its column, or from: control"),
        ({"known": {"back_emf": 0.1}}, "only where the effort is a voltage"),
        ({"control": {"kp": 1.0, "position": 2.0, "velocity": 1.0}}, "cascade, or kp"),
        ({"control": {"kp": 0.0}}, "gains of 0 a controller asks for nothing"),
        ({"predict": "closed_loop"}, "needs 'control' and 'reference'"),
        ({"body": {"mjcf": "a.xml"}}, "rig.yaml: body: name either the driven joint or the driven"),
        ({"body": 5}, "rig.yaml: body: a mapping of keys is needed"),
        ({"fit": {"inertia": 3}}, "fit.inertia: a mapping of keys is needed"),
        ({"time": {"column": "t", "unit": "s", "factor": 0}}, "a factor of 0"),
        ({"time": {"column": "t", "unit": "weeks"}}, "time.unit: 'weeks'; known: "),
        ({"known": {"scale": 0.0}}, "scale: at 0 no effort makes a torque"),
        ({"known": {"scale": -1.0}}, "scale: -1 is less than 0; effort.factor: -1 turns the sign"),
        ({"known": {"inertia": -0.03}, "fit": {}}, "inertia: -0.03 is less than 0; no machine"),
        ({"fit": {"viscous": {"nominal": -1, "low": -2, "high": 0}}}, "viscous: -1 is less than 0"),
        ({"gear": "1_000"}, "gear: '1_000' is no number"),
        ({"per_log": ["offset", "offset"]}, "'offset' is given twice"),
        ({"time": {"column": "t", "unit": "s", "factor": 1e-300}}, "time.factor: 1e-300 is no"),
        ({"gear": 1e308}, r"gear: 1e\+308 is no size of a machine"),
        ({"known": {"stiffness": -1e16}}, r"known.stiffness: -1e\+16 is no size"),
        ({"fit": {"inertia": {"nominal": 1, "low": 0, "high": 1e308}}}, "fit.inertia.high: 1e"),
        ({"gear": 10**39}, r"gear: 1e\+39 is no size"),
        ({"gear": ".inf"}, "gear: "),
        ({"gear": True}, "gear: 'true' is no number"),
        ({"known": {"scale": True}}, "known.scale: 'true' is no number"),
        ({"filter": {"cutoff": False}}, "filter.cutoff: 'false' is no number"),
        ({"effects": ["creep", "creep"]}, "effects: 'creep' is given twice"),
        ({"criteria": {"flor": 0.02}}, "criteria.flor: no such key"),
        ({"criteria": {"floor": 2.0}}, "criteria.floor: "),
        ({"criteria": {"most": -1}}, "criteria.most: "),
        ({"effort": {"column": "q", "unit": "A", "kind": "current"}}, "'q' is the column of posi"),
        ({"effects": ["creep"] * 5000}, "effects: List should have at most 100"),
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


@pytest.mark.parametrize(
    ("arm", "sentence"),
    [
        ({"units": 0}, r"units = 0 is out of range \[2, 200\]"),
        ({"units": 10**9}, r"units = 1000000000 is out of range"),
        ({"winch": {"gear_ratio": None}}, "winch.gear_ratio: a number is needed, got 'None'"),
        ({"winch": {"gear_ratio": 10**400}}, "winch.gear_ratio: a number is needed"),
    ],
)
def test_a_part_of_the_arm_that_cannot_be_is_a_sentence(arm, sentence):
    with pytest.raises(ConfigError, match=sentence):
        described(elsewhere.description(arm=arm), "rig.yaml").machine()


def test_a_key_that_is_given_twice_is_refused(tmp_path):
    text = yaml.safe_dump(description()) + "gear: 2\ngear: 3\n"
    with pytest.raises(ConfigError, match="'gear' is given twice, first in line"):
        load_rig(written(tmp_path, text))


def test_what_is_no_file_is_a_sentence(tmp_path):
    for path in (tmp_path, "/dev/zero", "a\0b"):
        with pytest.raises(DataError):
            load_rig(path)


ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)
WHOLE = {
    "rig": description(
        velocity={"column": "w", "unit": "rad/s"},
        control={"position": 1.0, "velocity": 1.0},
        known={"stiffness": 1.0},
        body={"mjcf": "a.xml", "joint": "j", "joints": {"k": {"column": "k", "unit": "rad"}}},
        rows={"minimum_speed": 0.1},
        criteria={"floor": 0.02, "most": 3},
        gear=2.0,
        effects=["creep"],
    ),
    "arm": elsewhere.description(
        arm={"winch": {"gear_ratio": 1.0}},
        known={"motor.rotor_inertia": 4e-5},
        criteria={"sure": 0.8},
        effects=["creep"],
    ),
}


def places(plain, place=()):
    """Every key of a nested mapping, as a path."""
    for key, value in plain.items():
        yield (*place, key)
        if isinstance(value, dict):
            yield from places(value, (*place, key))


@pytest.mark.parametrize("kind", WHOLE)
@given(data=st.data())
def test_anything_in_any_key_is_a_description_or_a_sentence(kind, data):
    plain = copy.deepcopy(WHOLE[kind])
    *above, key = data.draw(st.sampled_from(list(places(plain))))
    part = plain
    for name in above:
        part = part[name]
    part[data.draw(st.just(key) | st.text())] = data.draw(ANYTHING)
    try:
        rig = described(plain, "rig.yaml")
        if isinstance(rig, ArmFile):
            rig.machine()
    except ConfigError as error:
        assert str(error)


def test_a_speed_in_ticks_is_counted_by_the_encoder_of_the_position():
    ticks = {"unit": "tick", "per_turn": 4096}
    speed = {"column": "v", "unit": "tick/s"}
    told = description(position={"column": "q", **ticks}, velocity=speed)
    read = RigFile.model_validate(told).velocity
    assert read.scale == pytest.approx(2 * np.pi / 4096)
    own = description(position={"column": "q", **ticks}, velocity={**speed, "per_turn": 100})
    assert RigFile.model_validate(own).velocity.scale == pytest.approx(2 * np.pi / 100)


def test_a_duty_of_one_is_a_unit_as_text_and_as_a_number():
    for unit in (1, "1"):
        duty = {"column": "u", "unit": unit, "kind": "duty", "supply": 12.0}
        assert RigFile.model_validate(description(effort=duty)).effort.scale == 12.0


def test_bounds_so_wide_that_no_fit_resolves_the_nominal_value_are_refused():
    wide = {"inertia": {"nominal": 0.05, "low": 0.001, "high": 1e15}}
    with pytest.raises(ValueError, match=r"inertia: bounds .* hide it; give narrower ones"):
        RigFile.model_validate(description(fit=wide))
    RigFile.model_validate(description(fit={"inertia": {**wide["inertia"], "high": 1e6}}))
