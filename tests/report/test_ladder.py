"""The ladder's figure and table: every score with its interval, between two named ceilings."""

import pytest

from spirob.report.sections import discover
from spirob.report.sections.ladder import ceiling_sentence, ladder, rows

(LADDER,) = [s for s in discover() if s.name == "ladder"]


@pytest.fixture
def rungs(data):
    return data.diagnosis["ladder"]


def test_whiskers_end_where_the_intervals_do(rungs):
    figure = ladder(rungs, 0.0124, "A")
    drawn = {bar.name.split(" trials")[0]: bar for bar in figure.data if bar.type == "bar"}
    for name, split in (("held-out", "heldout"), ("training", "train")):
        bar = drawn[name]
        for k, rung in enumerate(rungs):
            low, high = rung["interval"][split]["rmse"]
            assert bar.x[k] - bar.error_x.arrayminus[k] == pytest.approx(low)
            assert bar.x[k] + bar.error_x.array[k] == pytest.approx(high)


def test_both_ceilings_are_drawn_and_named(rungs):
    lines = {shape.name: shape.x0 for shape in ladder(rungs, 0.0124, "A").layout.shapes}
    assert lines == {"flexible model, held out, 0.043 A": 0.0431, "sensor noise, 0.012 A": 0.0124}


def test_nothing_is_drawn_of_what_is_not_known(rungs):
    bare = [
        {k: v for k, v in r.items() if k not in ("interval", "ceiling", "train")} for r in rungs
    ]
    figure = ladder(bare, None, "A")
    assert not figure.layout.shapes
    assert all(not any(bar.error_x.array) for bar in figure.data if bar.type == "bar")


def test_the_table_holds_every_score_of_every_model(rungs):
    found = rows(rungs, 0.0124)
    assert len(found) == 3 * len(rungs) + 1
    assert [row["trials"] for row in found[:3]] == ["training", "validation", "held-out"]
    assert [row["label"] for row in found if row["fresh"]] == [
        *(rung["label"] for rung in rungs),
        "sensor noise",
    ]
    named = next(row for row in found if row["label"] == "with capstan friction")
    mae, rmse, r2 = named["cells"]
    assert float(mae[0]) == pytest.approx(0.76 * 0.0462, abs=6e-4)
    assert float(rmse[0]) == pytest.approx(0.0462, abs=6e-4)
    assert float(r2[0]) == pytest.approx(1 - (0.0462 / 0.51) ** 2, abs=6e-4)
    low, high = (float(text) for text in r2[1].split(" to "))
    assert low < float(r2[0]) < high


def test_a_rig_has_no_validation(rungs):
    found = rows([{k: v for k, v in r.items() if k != "validate"} for r in rungs], None)
    assert {row["trials"] for row in found} == {"training", "held-out"}
    assert {row["span"] for row in found} == {2}


def test_r2_shows_what_is_missing_to_one():
    rung = {"label": "a", "heldout": {"mae": 1.0, "rmse": 1.0, "r2": 0.99985}}
    (row,) = rows([rung], None)
    assert row["cells"][2][0] == "0.99985"


def test_the_page_says_what_could_still_be_explained(data, rungs):
    assert "explains 29 % of the squared error" in LADDER.get_context(data)["ceiling"]
    assert ceiling_sentence(rungs[:2], 0.3) == ""
    assert ceiling_sentence(rungs, None) == ""
