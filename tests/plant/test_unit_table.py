"""An arm from a table of its units, or from a design's numbers: the same arm, or a sentence."""

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from spirob.errors import ConfigError, SpirobError
from spirob.geometry import Drawing, spiral_arm
from spirob.plant import Plant, Rig
from spirob.plant.tendon import guides, room, shortenings, stroke
from spirob.robot import Scene
from spirob.unit_table import COLUMNS, Measured, with_table
from tests.physics.playing import currents
from tests.plant.measuring import rows_of, written

DRAWN = spiral_arm()
SHORT = {"units": 13, "b": 0.3, "length": 0.2, "base_width": 0.06, "hole_base": 0.8, "mount": 4e-3}
NUMBERS = ("a", "b", "unit_angle_deg", "units", "size", "length", "base_width", "hole_base")


def read(folder, text):
    (folder / "units.csv").write_text(text)
    return Rig.from_mapping({"geometry": with_table({"table": "units.csv"}, folder)})


@pytest.mark.parametrize("drawn", [DRAWN, Drawing.from_mapping(SHORT).arm()], ids=["24", "13"])
def test_a_drawing_that_was_measured_is_that_drawing(tmp_path, drawn):
    rig = read(tmp_path, written(rows_of(drawn)))
    assert rig.units == drawn.units
    for about in fields(drawn):
        found, known = (getattr(arm, about.name) for arm in (rig.lengths(), drawn))
        assert found == pytest.approx(known, rel=1e-9, abs=1e-12), about.name


def test_a_model_of_measured_units_moves_as_that_of_the_drawing(tmp_path):
    rig = read(tmp_path, written(rows_of(DRAWN)))
    still = currents(np.full(300, 0.5), 0.2)
    one, other = (Plant(r).simulate(still, Scene()) for r in (rig, Rig()))
    assert one.angles == pytest.approx(other.angles, abs=1e-6)


def test_the_columns_may_stand_in_any_order_and_lines_be_empty(tmp_path):
    rows = [row[::-1] for row in rows_of(DRAWN)]
    text = "\ufeff" + written(rows, COLUMNS[::-1]).replace("\n1", "\n\n1")
    assert read(tmp_path, text).lengths().unit_length == pytest.approx(DRAWN.unit_length)


def test_without_a_row_for_the_mount_its_hole_mirrors_the_first_units():
    arm = Measured.from_rows(rows_of(DRAWN)[1:]).arm()
    assert arm.guide_before[0] == pytest.approx([-1, 1] * DRAWN.guide_after[0])


@pytest.mark.parametrize("units", [13, 48, 60])
def test_cut_otherwise_it_has_the_same_length_turn_and_stroke(units):
    whole = Measured.from_rows(rows_of(DRAWN))
    cut = whole.arm(units)
    assert cut.length == pytest.approx(DRAWN.length)
    assert cut.unit_angle.sum() == pytest.approx(DRAWN.unit_angle.sum())
    wide, known = (
        np.interp(0.2, arm.hinge_position + arm.unit_length / 2, arm.half_width)
        for arm in (cut, DRAWN)
    )
    assert wide == pytest.approx(known, rel=0.01)
    turned = np.linspace(0.0, 1.0, units) * DRAWN.unit_angle.sum() / units
    same = spiral_arm(units)
    assert shortenings(turned, guides(cut)) == pytest.approx(
        shortenings(turned, guides(same)), rel=0.02
    )


def test_the_design_tools_numbers_give_its_widths_and_nearly_its_length():
    drawn = Drawing.from_mapping({"a": 4.9293e-3, "b": 0.1764, "unit_angle_deg": 30, "units": 24})
    assert drawn.base_width == pytest.approx(0.0837, rel=1e-3)
    assert drawn.base_width * np.exp(-0.1764 * np.pi / 6 * 23) == pytest.approx(0.01, rel=1e-3)
    assert drawn.length == pytest.approx(0.46408, rel=5e-3)


def test_twice_the_size_is_twice_every_length_and_room_of_the_holes():
    one, two = (Drawing.from_mapping({**SHORT, "size": s, "mount": 0.0}) for s in (1, 2))
    assert two.arm().guide_after == pytest.approx(2 * one.arm().guide_after)
    assert stroke(two.arm()) == pytest.approx(2 * stroke(one.arm()))
    (low, shift), (high, same) = (
        (room(d.arm())["holes.mount"].high, room(d.arm())["holes.shift"].high) for d in (one, two)
    )
    assert high == pytest.approx(2 * low)
    assert shift == pytest.approx(same)


def changed(unit, **cells):
    rows = rows_of(DRAWN)
    for name, value in cells.items():
        rows[unit][COLUMNS.index(name)] = value
    return rows


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (changed(3, near_y_mm=60.0), "unit 3: near_y_mm = 60: the hole lies outside of the unit"),
        (changed(3, far_y_mm=-1.0), "unit 3: far_y_mm = -1: the hole lies outside of the unit"),
        (changed(3, near_x_mm=1.0), "unit 3: near_x_mm: the hole's mouth stands .* mm out of its"),
        (changed(5, edge_mm=-0.5), "unit 5: edge_mm = -0.5: its faces cross"),
        (changed(5, edge_mm=99.0), "unit 5: edge_mm = 99 is not below length_mm"),
        (changed(5, far_x_mm=2.0), "unit 5: near_x_mm = .* is not nearer to the base than far_x"),
        (changed(7, width_mm=0.0), "unit 7: width_mm = 0 is out of range"),
        (changed(7, length_mm=None), "unit 7: length_mm: a number is needed, got None"),
        (changed(0, far_x_mm=5.0), "unit 0: the mount's hole at 5, .* lies behind the first hinge"),
        (rows_of(DRAWN)[:4] + rows_of(DRAWN)[5:], "unit 4 is missing: in its place stands unit 5"),
        (rows_of(DRAWN)[:2], "1 units; an arm has 2 to 200"),
        (changed(2, width_mm="wide"), "row 4, width_mm: 'wide' is no number"),
    ],
)
def test_a_table_that_cannot_be_is_one_sentence_with_file_and_place(tmp_path, rows, said):
    with pytest.raises(ConfigError, match=f"units.csv: {said}"):
        read(tmp_path, written(rows))


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ({"units": 1}, "units = 1 is out of range"),
        ({"units": 12.5}, "units = 12.5 is no whole number"),
        ({"size": 0}, "size = 0; it is above 0"),
        ({"length": 0.464, "base_width": 0.2}, "faces slanted by 15° cross inside of units"),
        ({"hole_tip": 1.1}, "hole_tip = 1.1 is out of range"),
        ({"mount": -0.02}, "mount = -0.02 m puts the mount's hole ahead of the first hinge"),
        ({"length": 0.3}, "length and base_width belong together"),
        ({"a": 0.005, "length": 0.3}, "either a or length"),
        ({"widht": 0.3}, "no key 'widht'; it has: a, b"),
        ({"b": "steep"}, "b: a number is needed, got 'steep'"),
        ({"rows": 3}, "rows: a list of rows"),
    ],
)
def test_numbers_that_cannot_be_are_one_sentence_with_the_key(numbers, said):
    with pytest.raises(ConfigError, match=f"geometry.*{said}"):
        Rig.from_mapping({"geometry": numbers})


@pytest.mark.parametrize("name", ["../units.csv", "/etc/passwd", "absent.csv", 3])
def test_a_table_lies_beside_its_rig(tmp_path, name):
    with pytest.raises(SpirobError):
        with_table({"table": name}, tmp_path)


CELL = st.one_of(st.none(), st.text(max_size=4), st.floats(-1e4, 1e4, width=32))


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 24), st.integers(0, 7), CELL, st.integers(0, 24))
@example(0, 0, "\n", 0)
def test_whatever_stands_in_a_cell_ends_in_an_arm_or_a_sentence(row, column, cell, until):
    rows = rows_of(DRAWN)[: until + 1]
    rows[min(row, until)][column] = cell
    try:
        arm = Rig.from_mapping({"geometry": {"rows": rows}}).lengths()
    except ConfigError as error:
        assert str(error).startswith("geometry: ")
        assert "\n" not in str(error)
    else:
        require_possible(arm)


@settings(max_examples=150, deadline=None)
@given(st.dictionaries(st.sampled_from(NUMBERS), st.floats(-1.0, 40.0, width=32), max_size=5))
def test_whatever_a_design_says_ends_in_an_arm_or_a_sentence(numbers):
    try:
        rig = Rig.from_mapping({"geometry": numbers})
    except ConfigError as error:
        assert str(error).startswith("geometry")
    else:
        require_possible(rig.lengths())


def require_possible(arm):
    """Faces do not cross, and tendons run between axis and edge from the base to the tip."""
    inset = np.tan(arm.unit_angle / 2) * arm.half_width
    assert np.all(2 * inset < arm.unit_length)
    assert np.all(arm.guide_after[:, 1] > 0.0)
    assert np.all(arm.guide_after[:, 1] < arm.half_width)
    assert np.all(arm.guide_before[:, 0] < arm.guide_after[:, 0])
    assert np.isfinite(stroke(arm))
    assert stroke(arm) > 0.0
