"""The section on the trial: every part is there if its numbers are."""

from dataclasses import replace

import pytest

from spirob.report import render
from spirob.report.sections import trial
from spirob.report.sections.trial import Trial, rates
from tests.report.synthetic_results import TRIAL


def test_rates_come_with_interval_and_number_and_empty_ones_are_left_out():
    rows = rates(TRIAL)
    assert [row["n"] for row in rows] == ["50", "12"]
    assert rows[0]["value"] == "78 %"
    assert rows[0]["interval"] == "68 % to 88 %"


def test_answers_are_in_the_order_of_the_rows_they_lead_and_refusals_last():
    assert trial.answers(TRIAL["confusion"]) == [
        "capstan_friction",
        "coulomb_friction",
        "undecided",
        "unknown",
        "nothing_missing",
    ]


def test_the_matrix_holds_every_count():
    (heat,) = trial.confusion(TRIAL["confusion"]).data
    assert [[t or "0" for t in line] for line in heat.text] == [
        ["4", "0", "1", "0", "0"],
        ["1", "3", "0", "1", "0"],
        ["0", "0", "0", "0", "5"],
    ]
    assert heat.z[0][0] == pytest.approx(80.0)


def test_bins_without_robots_are_not_drawn():
    assert trial.reliability(TRIAL["reliability"]).data[1].x == pytest.approx((71, 98))
    figure = trial.strength([*TRIAL["strength"], {"low": 0, "high": 0.1, "n": 0}])
    assert figure.data[0].x == pytest.approx((25, 55))
    assert figure.data[0].error_y.arrayminus == pytest.approx((21, 15))


@pytest.mark.parametrize("absent", ["confusion", "reliability", "strength"])
def test_each_part_may_be_absent(data, absent):
    trial = {key: value for key, value in data.trial.items() if key != absent}
    shown = Trial().get_context(replace(data, trial=trial))["plots"]
    names = [one["plot"].name for one in shown]
    assert names == [n for n in ("reliability", "strength", "confusion") if n != absent]


def test_a_trial_by_another_diagnosis_is_not_called_the_same(data):
    def page(by):
        return render(replace(data, trial={**data.trial, "by": by}), [Trial()])

    assert "The same diagnosis, blind, in 62 cases" in page(None)
    other = page("the diagnosis of another day")
    assert "The same diagnosis" not in other
    assert "played blind by the diagnosis of another day. The diagnosis above is a later" in other


def test_without_a_trial_the_section_says_so(sparse):
    context = Trial().get_context(sparse)
    assert not context["ran"]
    assert context["reason"].startswith("No trial was run here")
