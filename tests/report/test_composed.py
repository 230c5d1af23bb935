"""A law of the arm on its page, and the sentence where there is none."""

from dataclasses import replace

from spirob.report import render
from spirob.report.sections.composed import Composed

LAW = {
    "file": "law.py",
    "sentence": "A law of this shape takes 95% of the squared error that is left.",
    "formula": "τ = -(0.001 N·m·tanh(v/v_0))",
    "terms": ["way × spot"],
    "numbers": {"centre_1": {"value": 0.009, "low": 0.008, "high": 0.010, "unit": "m"}},
    "range": {"place": [-0.05, 0.05], "speed": [-40.0, 40.0]},
}


def test_a_law_is_shown_with_what_switches_it_on(data):
    told = {**data.diagnosis, "verdict": "unknown", "composed": LAW}
    shown = replace(data, diagnosis=told)
    page = render(shown, [Composed()])
    assert LAW["sentence"].replace("%", " %") in page
    assert "plant.effects=[data/diagnosis/law.py]" in page
    assert Composed().get_context(shown)["plot"].label.endswith("over position")


def test_without_one_a_sentence_says_when_it_is_asked_for(data):
    page = render(data, [Composed()])
    assert "no law was composed: it is asked for where" in page
