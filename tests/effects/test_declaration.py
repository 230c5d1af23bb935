"""A wrong declaration is refused when the class is made, with a sentence that helps."""

import pytest

from spirob.effects import all_effects, find_effects, load_file
from spirob.errors import ConfigError, EffectError
from tests.effects.test_broken import friction, with_kernel

NOT_A_METHOD = {"kernel": friction}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"port": "motor.smell"}, r"port 'motor\.smell' is unknown; ports: .*motor\.torque"),
        ({"port": ""}, "port '' is unknown"),
        ({"reads": {"speed": "motor.pace"}}, r"reads 'motor\.pace'; signals: .*motor\.speed"),
        ({"reads": {"speed": "hinge.speed"}}, r"'hinge\.speed', not seen at motor\.torque"),
        ({"reads": {"speed": "motor.speed"}}, r"kernel takes \(speed, rest_speed, torque\)"),
        ({"state": {"way": 0.0}}, "declared: speed, rest_speed, way, torque"),
        ({"port": "motor.drive_torque"}, "declared: upstream, speed, rest_speed, torque"),
        ({"port": "body.tip_mass"}, r"not seen at body\.tip_mass"),
        (
            {"port": "body.tip_mass", "reads": {}, "state": {"way": 0.0}},
            "asked once, so there is nothing to remember",
        ),
        ({"neutral": {}}, "no neutral numbers"),
        ({"neutral": {"force": 0.0}}, "neutral names 'force'; numbers: torque"),
        ({"neutral": {"torque": -1.0}}, r"neutral torque = -1\.0 is outside its bounds"),
        ({"traits": {"pleasant"}}, r"unknown traits \['pleasant'\]; known: .*dissipative"),
        ({"evolution": {"way": "speed"}}, r"evolution of \['way'\]"),
        ({"title": ""}, "'title' is empty"),
        ({"signature": ""}, "'signature' is empty"),
        ({"explanation": ""}, "'explanation' is empty"),
        (NOT_A_METHOD, "must be a static method"),
    ],
)
def test_a_wrong_declaration_is_a_sentence(changes, sentence):
    with pytest.raises(EffectError, match=sentence):
        with_kernel(friction, **changes)


@pytest.mark.parametrize(
    ("line", "error", "sentence"),
    [
        ('bounded(2.0, 0.0, 0.05, "N·m", "T", "level")', EffectError, r"nominal 2\.0 is outside"),
        ('bounded(0.0, 0.0, 1.0, "N·m", "T", "level", log=True)', EffectError, "log scale"),
        ('bounded(0.0, 0.0, 0.05, "", "T", "level")', EffectError, "needs a unit, a symbol"),
        ('bounded(0.0, 0.0, 0.05, "N·m", "speed", "level")', EffectError, "'speed' has two mean"),
    ],
)
def test_a_wrong_number_is_a_sentence(tmp_path, line, error, sentence):
    path = tmp_path / "own.py"
    path.write_text(OWN.format(line=line))
    with pytest.raises(error, match=sentence):
        load_file(path)


OWN = """
from spirob.effects import Effect
from spirob.parameter import bounded

class Own(Effect):
    port = "motor.torque"
    reads = {{"speed": "motor.speed"}}
    neutral = {{"torque": 0.0}}
    title, signature, explanation = "a", "b", "c"
    torque: float = {line}

    @staticmethod
    def kernel(speed, torque):
        return -torque * speed
"""
GOOD = OWN.format(line='bounded(0.0, 0.0, 0.05, "N·m·s", "T", "level")')


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x = 1", "defines no effect"),
        ("def broken(:", "SyntaxError"),
        ("import no_such_module_at_all", "ModuleNotFoundError"),
        (GOOD + GOOD[GOOD.index("class") :].replace("Own", "Other"), "an effect is one file"),
    ],
)
def test_a_file_that_is_no_effect_is_a_sentence(tmp_path, text, sentence):
    path = tmp_path / "own.py"
    path.write_text(text)
    with pytest.raises(EffectError, match=sentence):
        load_file(path)


def test_a_file_that_is_absent_is_a_sentence(tmp_path):
    with pytest.raises(EffectError, match="cannot be read"):
        find_effects([str(tmp_path / "absent.py")])


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(EffectError, match=r"no effect 'coulomb'; known: .*coulomb_friction"):
        find_effects(["coulomb"])


def test_a_value_out_of_its_bounds_is_a_sentence():
    with pytest.raises(ConfigError, match=r"coulomb_friction\.coulomb_torque = 9\.0 N·m is out"):
        all_effects()["coulomb_friction"](coulomb_torque=9.0)


def test_an_effect_is_named_by_its_file(tmp_path):
    path = tmp_path / "my_own_drag.py"
    path.write_text(GOOD)
    assert [e.name() for e in find_effects([str(path), "creep"])] == ["my_own_drag", "creep"]
