"""The section on pushes: what was not played has a dash, and no robot leaves the model's column."""

from spirob.report.sections.passive import rows
from tests.report.synthetic import passive

FOUND = passive()


def test_a_row_for_each_figure_with_its_aim():
    told = {row["what"]: (row["cells"], row["aim"]) for row in rows(FOUND["model"], FOUND["robot"])}
    assert told["felt at the outer half"] == (["100 %", "100 %"], "≥ 95 %")
    assert told["felt at the base"] == (["84 %", "–"], "")
    assert told["false alarms a minute"] == (["0.0", "0.0"], "≤ 1 a minute")
    assert told["until felt, 95 % [ms]"] == (["150", "150"], "")
    assert told["region right, of those felt"] == (["93 %", "93 %"], "≥ 80 %")


def test_without_a_robot_its_column_is_empty():
    assert {row["cells"][1] for row in rows(FOUND["model"], {})} == {"–"}
