"""Equations become MathML that is well formed and says the same."""

import xml.etree.ElementTree as ElementTree

import pytest

from spirob.effects import all_effects
from spirob.report.sections.library import card, equation, equations, expression, symbol, word

EFFECTS = all_effects()


def plain(markup):
    """The text of an expression with brackets where fractions and powers had none."""
    return "".join(ElementTree.fromstring(f"<math>{markup}</math>").itertext())


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("-T_c*tanh(speed/w)", "−Tc⋅tanh(speedw)"),
        ("(a + b)*c", "(a+b)⋅c"),
        ("a*(b - c)", "a⋅(b−c)"),
        ("a - (b - c)", "a−(b−c)"),
        ("a - b*c", "a−b⋅c"),
        ("-(a + b)", "−(a+b)"),
        ("a*-b", "a⋅(−b)"),
        ("2*Max(a, 0)", "2⋅max(a,0)"),
        ("Abs(speed)", "|speed|"),
        ("(a/b)**2", "(ab)2"),
        ("c*(a/b)", "c⋅ab"),
    ],
)
def test_brackets_stand_where_they_are_needed(text, shown):
    assert plain(expression(text, {"a", "b", "c", "w", "T_c"})) == shown


def test_powers_and_fractions_are_set_as_such():
    assert (
        expression("a**2", {"a"}) == "<msup><mrow><mi>a</mi></mrow><mrow><mn>2</mn></mrow></msup>"
    )
    assert expression("(a + b)**2", {"a", "b"}).startswith("<msup><mrow><mrow><mo>(</mo>")
    assert expression("a/b", {"a", "b"}).startswith("<mfrac>")
    assert expression("exp(-a)", {"a"}).startswith("<msup><mi>e</mi>")
    assert expression("exp(a)**2", {"a"}).count("<mo>(</mo>") == 1


def test_symbols_have_indices_and_signals_are_words():
    assert symbol("T_c") == "<msub><mi>T</mi><mi>c</mi></msub>"
    assert symbol("A_2") == "<msub><mi>A</mi><mn>2</mn></msub>"
    assert word("rest_speed") == "<mtext>rest speed</mtext>"


def test_a_micro_sign_is_the_letter():
    assert "<mi>μ</mi>" in expression("\u00b5*a", {"\u00b5"})


@pytest.mark.parametrize("text", ["a if b else c", "a.b", "f(*a)", "[a]", "a @ b", "a +", "'a'"])
def test_what_is_no_formula_is_refused(text):
    with pytest.raises(SyntaxError):
        equation(word("torque"), text, {"a", "b"})


@pytest.mark.parametrize("name", EFFECTS)
def test_every_effect_of_the_library_is_set_with_all_its_symbols(name):
    effect = EFFECTS[name]
    lines = equations(effect)
    assert len(lines) == bool(effect.equation) + len(effect.evolution)
    text = "".join("".join(ElementTree.fromstring(line).itertext()) for line in lines)
    used = f"{effect.equation} {' '.join(effect.evolution.values())}"
    for number in effect.parameters().values():
        if number.symbol in used.replace("(", " ").replace("*", " ").split():
            assert number.symbol.replace("_", "") in text


@pytest.mark.parametrize("name", EFFECTS)
def test_every_card_is_complete(name):
    about = card(EFFECTS[name])
    assert all(about[key] for key in ("title", "explanation", "signature", "numbers", "does"))
    assert any(number["absent_at"] for number in about["numbers"])
