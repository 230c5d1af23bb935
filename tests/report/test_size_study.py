"""The section on what size rests on: who is better, how surely, and what is drawn."""

from dataclasses import replace

import pytest

from spirob.report.sections import size_study
from spirob.report.sections.size_study import (
    SHIPPED,
    SizeStudy,
    better,
    choice,
    side_by_side,
    unlisted,
)
from tests.report.synthetic_results import rival, size


def test_a_better_rival_is_told_and_that_it_is_not_sure():
    told = better(size())
    assert "SVR alone in simulation (1.25 for 1.31 mm)" in told
    assert "on the robot" not in told
    assert "of none of them sure" in told


def test_a_sure_difference_is_told_as_sure():
    metrics = size()
    metrics["robot"]["other"]["svr"] = rival(3.0, -0.42, 0.2)
    assert "sure only of SVR alone on the robot" in better(metrics)


def test_where_none_is_better_that_is_said():
    metrics = size()
    metrics["simulation"]["other"]["svr"] = rival(1.4, 0.09, 0.2)
    assert better(metrics) == "None of the others is better on these tests."


def test_unlisted_diameters_are_told_beside_all():
    assert unlisted(size()["robot"]).endswith(
        "on these the MAE is 2.90 mm (2.10 to 3.80), on all 28 3.42 mm."
    )
    assert unlisted({"mae": 1.0}) == ""


def test_what_the_training_chose_is_told_with_its_error():
    told = choice(size()["training"]["chosen"])
    assert told.startswith("Of 2 combinations of its numbers")
    assert "least rank correlation of a feature 0.5 and price of leaving the tube 100: 1.04" in told
    assert choice([]) == ""


def test_the_shipped_predictor_comes_first_with_its_interval():
    errors = side_by_side(size())
    assert next(iter(errors)) == SHIPPED
    shipped = size_study.predictors(errors).data[0]
    assert shipped.x[0] - shipped.error_x.arrayminus[0] == pytest.approx(0.8 * 1.31)
    assert shipped.x[0] + shipped.error_x.array[0] == pytest.approx(1.2 * 1.31)


def test_the_learning_curve_has_an_interval_at_each_step():
    curve = size()["training"]["learning_curve"]
    line = size_study.learning_curve(curve).data[1]
    assert line.x == (20, 35)
    assert line.error_y.array == pytest.approx((0.6, 0.6))
    assert line.error_y.arrayminus == pytest.approx((0.5, 0.5))


def test_features_are_told_with_meaning_and_unit(data):
    plots = {plot.name: plot for plot in SizeStudy().get_context(data)["plots"]}
    assert list(plots) == ["size-predictors", "size-learning", "size-importance"]
    bar = plots["size-importance"].figure.data[0]
    assert bar.y == ("stall time", "onset stroke")
    assert bar.customdata[0].endswith("[s]")
    for plot in plots.values():
        axes = plot.figure.layout.xaxis.title.text, plot.figure.layout.yaxis.title.text
        assert any("[mm]" in (title or "") for title in axes)


def test_each_part_may_be_absent(data):
    bare = {domain: {"mae": 1.0} for domain in ("simulation", "robot")}
    context = SizeStudy().get_context(replace(data, metrics=data.metrics | {"size": bare}))
    assert context["plots"] == []
    assert context["reason"] == "This run compared no predictors."
