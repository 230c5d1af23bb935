"""The section on contacts: both thresholds, both domains, parts without a contact left out."""

import copy
from dataclasses import replace

import pytest

from spirob.report.sections.contacts import (
    Contacts,
    delay_along,
    hits_along,
    left_edge,
    roc,
    rows,
)
from tests.report.synthetic_results import contacts

SIGNAL = contacts()["current"]


def test_a_row_for_each_thresholds_and_domain():
    found = rows("raw current", SIGNAL)
    assert [(row["thresholds"], row["where"]) for row in found] == [
        ("the paper's", "simulation"),
        ("the paper's", "robot"),
        ("tuned", "simulation"),
        ("tuned", "robot"),
    ]
    assert found[2]["cells"] == ["99 %", "32 %", "64 %", "97 %", "198", "397", "0.00"]


def test_no_false_alarm_is_drawn_at_the_left_edge_of_the_axis():
    figure = roc(SIGNAL)
    edge = left_edge(SIGNAL)
    assert edge == pytest.approx(0.02)
    curve = figure.data[0]
    assert curve.x == pytest.approx((140.0, 0.06, edge, edge))
    assert figure.layout.xaxis.ticktext[0] == "0"
    assert figure.layout.xaxis.tickvals[0] == edge
    assert all(tick > edge for tick in figure.layout.xaxis.tickvals[1:])


def test_the_marks_are_the_rates_of_both_thresholds():
    marks = {trace.name: (trace.x[0], trace.y[0]) for trace in roc(SIGNAL).data[2:]}
    assert set(marks) == {
        f"{how}, {where}" for how in ("the paper's", "tuned") for where in ("simulation", "robot")
    }
    assert marks["the paper's, robot"] == pytest.approx((0.02, 36.0))
    assert marks["tuned, robot"] == pytest.approx((0.02, 64.0))


def test_an_axis_without_any_false_alarm_can_be_drawn():
    calm = copy.deepcopy(SIGNAL)
    for domain in ("simulation", "robot"):
        for point in calm[domain]["roc"]:
            point["alarms"] = 0.0
    assert left_edge(calm) > 0.0
    assert roc(calm)


def test_parts_without_a_contact_are_not_drawn_nor_delays_of_what_was_never_told():
    assert hits_along(SIGNAL).data[0].x == pytest.approx((50, 90))
    (delay, *_) = delay_along(SIGNAL).data
    assert delay.y == pytest.approx((569.0,))
    assert delay.error_y.array == pytest.approx((569.0,))


def test_every_axis_has_its_unit():
    for draw in (
        roc,
        hits_along,
        delay_along,
    ):
        layout = draw(SIGNAL).layout
        assert "[" in layout.xaxis.title.text
        assert "[" in layout.yaxis.title.text or layout.yaxis.ticksuffix == " %"


def test_gaps_and_motions_have_a_line_each(data):
    (raw, _) = Contacts().get_context(data)["tables"]
    assert list(raw["lines"]) == ["gap of 6 mm", "gap of 18 mm", "35 mm/s against 0.10 A"]
    assert raw["lines"]["gap of 6 mm"][:2] == ["36 % of 200, 569 ms", "64 % of 200, 198 ms"]
    assert set(raw["lines"]["gap of 18 mm"]) == {"–"}


def test_rates_without_parts_leave_the_figures_along_the_arm_out(data):
    whole = copy.deepcopy(data.contacts)
    for signal in whole.values():
        for domain in ("simulation", "robot"):
            for rules in ("paper", "tuned"):
                for part in ("by_place", "by_gap", "by_motion"):
                    del signal[domain][rules][part]
    context = Contacts().get_context(replace(data, contacts=whole))
    assert (context["along"], context["tables"]) == ([], [])
    assert len(context["curves"]) == 2


def test_without_contacts_the_section_says_how_to_play_them(sparse):
    assert "was not tested here" in Contacts().get_context(sparse)["reason"]
