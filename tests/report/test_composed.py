"""A law of the arm on its page, and the sentence where there is none."""

from dataclasses import replace

import numpy as np
import pandas as pd

from spirob.report.builder import render
from spirob.report.sections.composed import Composed

LAW = {
    "file": "law.py",
    "sentence": "A law of this shape takes 95% of the squared error that is left.",
    "formula": "τ = -(0.001 N·m·tanh(v/v_0))",
    "terms": ["way × spot"],
    "numbers": {"centre_1": {"value": 0.009, "low": 0.008, "high": 0.010, "unit": "m"}},
    "range": {"place": [-0.05, 0.05], "speed": [-40.0, 40.0]},
}


def drawing():
    x = np.linspace(0.0, 0.05, 50)
    columns = {"effect": "law", "axis": "m", "position": x, "velocity": 0.01, "time": x}
    columns |= {"effort": 0.5, "shown": 0.02 * np.sin(100.0 * x), "law": 0.02, "band": 0.002}
    return pd.DataFrame(columns)


def test_a_law_is_shown_with_what_switches_it_on(data):
    told = {**data.diagnosis, "verdict": "unknown", "composed": LAW}
    page = render(replace(data, diagnosis=told, composed=drawing()), [Composed()])
    assert LAW["sentence"] in page
    assert "plant.effects=[data/diagnosis/law.py]" in page
    assert "position [m]" in page
    assert "current [A]" in page or "current [mA]" in page


def test_without_one_a_sentence_says_when_it_is_asked_for(data):
    page = render(data, [Composed()])
    assert "No law was composed: it is asked for where" in page
