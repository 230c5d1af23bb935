"""`spirob effects check` asks every law, of the kernel and of the model, and tells each answer."""

import pytest

from spirob.cli.main import main
from spirob.effects.check import LAWS
from spirob.plant.check import LAWS as MODEL_LAWS
from tests.effects.effects import TEMPLATE

RETURNED = "return -drag * math.exp(-warmth) * math.tanh(speed / rest_speed), warmth"


@pytest.fixture
def checked(tmp_path, capsys):
    """Check the template with something replaced: exit code, and what is said of each law."""

    def run(old="", new="", *flags):
        text = TEMPLATE.read_text(encoding="utf-8")
        assert old in text
        (tmp_path / "own_seal.py").write_text(text.replace(old, new), encoding="utf-8")
        code = main(["effects", "check", str(tmp_path / "own_seal.py"), *flags])
        lines = [line.split(": ", 2)[1:] for line in capsys.readouterr().out.splitlines()]
        return code, {line[0]: line[1] for line in lines if len(line) == 2}

    return run


def test_a_sound_effect_keeps_every_law_of_both_kinds(checked):
    code, said = checked()
    assert code == 0
    assert list(said) == [*LAWS, "exported", *MODEL_LAWS]
    assert all(text.startswith("kept: ") for text in said.values())


def test_an_effect_that_nothing_shows_breaks_a_law_of_the_model_only(checked):
    code, said = checked("bounded(0.002, 0.0, 0.05", "bounded(1e-9, 0.0, 0.05")
    assert code == 2
    assert said["recovery"].startswith("kept: ")
    assert said["seen"].startswith("broken: the arm does not show it")
    assert said["found"] == "not asked, as it breaks 'seen'"


def test_alone_the_model_is_not_asked(checked):
    code, said = checked("bounded(0.002, 0.0, 0.05", "bounded(1e-9, 0.0, 0.05", "--alone")
    assert code == 0
    assert {said[law] for law in MODEL_LAWS} == {"not asked (--alone)"}


def test_a_kernel_that_cannot_be_written_as_c_is_told_where(checked):
    same = RETURNED.replace("math.tanh(speed / rest_speed)", "math.erf(speed / rest_speed)")
    code, said = checked(RETURNED, same, "--alone")
    assert code == 2
    assert "its kernel holds a call of 'math.erf'" in said["exported"]


def test_a_kernel_that_breaks_its_own_laws_is_not_put_into_the_model(checked):
    code, said = checked(RETURNED, RETURNED.replace("return -drag", "return drag"))
    assert code == 2
    assert said["equation"].startswith("broken: the kernel gives")
    assert said["traits"].startswith("broken: it is not dissipative")
    assert said["seen"].startswith("not asked")


def test_a_kernel_that_cannot_be_compiled_is_a_sentence(checked):
    code, said = checked("warmth = final +", "warmth = math.fsum((final,)) +")
    assert code == 2
    assert said["compiled"].startswith("broken: it cannot be compiled")
