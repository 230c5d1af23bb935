"""A log is cut where it breaks; pieces and logs of which nothing is left are skipped and said."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.errors import DataError, NothingLeft
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.grids import FILLED, _grid
from spirob.machine.recordings.recording import prepare
from spirob.machine.recordings.selection import filtered_alike, split
from tests.machine.rigs import description

RIG = RigFile.model_validate(description())
RATE = 500


def log(seconds=12.0):
    t = np.arange(0, seconds, 1 / RATE)
    q = 2 * np.sin(2 * np.pi * 0.7 * t) + 0.3 * np.sin(2 * np.pi * 1.9 * t)
    return {"t": t, "q": q, "u": 0.4 * np.cos(2 * np.pi * 0.7 * t) + 0.01 * np.sin(40 * t)}


def said_of(made, text):
    return any(text in said for said in made.said)


def stood_after(seconds):
    """The axis stands from there on, behind a gap."""
    columns = log()
    still = columns["t"] > seconds
    columns["q"][still] = columns["q"][np.argmax(still)]
    columns["t"][still] += 0.5
    return columns


def test_a_piece_that_stands_is_skipped_unless_holds_are_kept():
    made = prepare("log", stood_after(9.0), RIG)
    assert len(made.pieces) == 1
    assert said_of(made, "1 pieces that stand skipped")
    keeping = RigFile.model_validate(description(rows={"standstill": "keep"}))
    assert len(prepare("log", stood_after(9.0), keeping).pieces) == 2


def test_a_piece_without_compared_rows_is_skipped():
    columns = {name: np.delete(v, slice(1000, 1100)) for name, v in log().items()}
    columns = {name: np.delete(v, slice(1300, 1400)) for name, v in columns.items()}
    rig = RigFile.model_validate(description(filter={"cutoff": 5.0}))
    made = prepare("log", columns, rig)
    assert len(made.pieces) == 2
    assert said_of(made, "1 pieces that hold no rows skipped")


@pytest.mark.parametrize(
    ("steps", "holes"),
    [
        ([0.002] * 500 + [0.0125] * 200, 0),  # it waits at one rate and moves at another
        ([0.008, 0.024] * 200, 0),
        ([0.002] * 300 + [0.0125] + [0.002] * 300, 1),
    ],
)
def test_a_step_is_a_hole_beside_the_steps_around_it(steps, holes):
    seconds = np.cumsum(steps)
    grid = _grid(seconds, {"q": np.sin(seconds)}, min(steps))
    edges = np.diff(np.r_[0.0, grid[FILLED], 0.0])
    assert np.count_nonzero(edges > 0) == holes


@pytest.mark.parametrize("name", ["q", "u"])
def test_a_run_without_numbers_is_cut_out(name):
    columns = log()
    columns[name][2000:2600] = np.nan
    made = prepare("log", columns, RIG)
    assert [len(p.q) for p in made.pieces] == [2000, 3400]
    assert said_of(made, f"'{name}' has no number in 600 rows in a run; the log was cut there")
    whole = prepare("log", log(), RIG).pieces[0]
    late = made.pieces[1]
    np.testing.assert_allclose(late.v[late.use], whole.v[2600:][late.use], atol=0.02)


def test_a_column_of_a_slower_topic_sets_the_rate():
    columns = log()
    columns["u"][np.arange(len(columns["u"])) % 4 > 0] = np.nan
    made = prepare("log", columns, RIG)
    assert made.period == pytest.approx(4 / RATE)
    assert said_of(made, "'u' has a number in 1500 of 6000 rows only")


def test_two_topics_joined_row_by_row_are_put_on_one_grid():
    columns = {name: np.repeat(v, 2) for name, v in log().items()}
    columns["t"][1::2] += 0.5 / RATE
    columns["q"][1::2] = columns["u"][::2] = np.nan
    made, whole = prepare("log", columns, RIG), prepare("log", log(), RIG)
    assert made.period == pytest.approx(1 / RATE)
    piece, same = made.pieces[0], whole.pieces[0]
    v = np.interp(piece.seconds, same.seconds, same.v)
    np.testing.assert_allclose(piece.v[piece.use], v[piece.use], atol=0.01)


def test_a_log_that_is_mostly_broken_is_refused():
    columns = log()
    index = np.arange(len(columns["u"]))
    columns["u"][(index % 400 > 150) & (index > 1500)] = np.nan
    with pytest.raises(DataError, match=r"it is broken .* are left in pieces of half a second"):
        prepare("log", columns, RIG)


def read(columns, cutoff):
    rest = {key: values for key, values in columns.items() if key != "name"}
    return prepare(columns["name"], rest, RIG, cutoff=cutoff)


def named(name, columns, **changes):
    return {**columns, **changes, "name": name}


def test_logs_of_which_nothing_is_left_are_left_out_and_said():
    good = log()
    still, short = named("still", good, q=np.full(6000, 1.0)), named("short", log(0.4))
    train, test = filtered_alike(read, [named("a", good), still], [short, named("b", good)])
    assert [r.name for r in train] == ["a"]
    assert [r.name for r in test] == ["b"]
    assert said_of(train[0], "still: column 'q' is constant at 1; nothing can be told from it; the")
    assert said_of(train[0], "short: 0.4 s long")
    with pytest.raises(DataError, match=r"still: .*; short: "):
        filtered_alike(read, [still, short], [named("b", good)])
    with pytest.raises(NothingLeft):
        read(still, None)


def test_the_end_of_a_log_in_pieces_is_held_out():
    columns = {name: np.delete(v, slice(3000, 3300)) for name, v in log().items()}
    (kept,), (held,), _ = split([prepare("log", columns, RIG)], [])
    begin = min(p.seconds[p.use].min() for p in held.pieces)
    assert max(p.seconds[p.use].max() for p in kept.pieces) < begin
    rows, way = (
        [sum(float(many(p)[p.use].sum()) for p in r.pieces) for r in (kept, held)]
        for many in (lambda p: np.ones(len(p.q)), lambda p: np.abs(p.v))
    )
    assert min(rows[1] / sum(rows), way[1] / sum(way)) == pytest.approx(0.3, abs=0.01)


def test_a_log_too_short_to_be_divided_is_fitted_as_a_whole_and_said():
    long = prepare("long", log(), RIG)
    sparse = replace(prepare("sparse", log(), RIG), every=250)  # 23 rows are compared
    kept, held, said = split([long, sparse, prepare("short", log(3.0), RIG)], [])
    assert [r.name for r in held] == ["long (end)"]
    assert all(r.pieces for r in kept)
    whole = "too short to be divided; fitted as a whole."
    assert said[1:] == [f"sparse: {whole}", f"short: {whole}"]
    with pytest.raises(NothingLeft, match=r"sparse: too short .* 27 rows that are compared"):
        split([sparse], [])


CONTROL = {"control": {"kp": 5.0}, "reference": {"column": "r", "unit": "rad"}}


@pytest.mark.parametrize("hurt", ["jump", "spike", "wrap", "slow"])
def test_a_reference_is_repaired_as_the_position_that_follows_it(hurt):
    """What a controller asks for follows from the difference of both, as they were logged."""
    effort = {"unit": "A", "kind": "current", "from": "control"}
    rig = RigFile.model_validate(description(effort=effort, **CONTROL))
    columns = log()
    columns["r"] = columns["q"] + 0.02 * columns.pop("u")
    clean = prepare("log", {name: v.copy() for name, v in columns.items()}, rig)
    if hurt == "jump":
        columns["q"][2750:] += 27.3
        columns["r"][2750:] += 27.3
    if hurt == "spike":  # no larger than the position, and large beside what is left to follow
        columns["r"][2001] = 0.7
    if hurt == "wrap":
        columns["q"], columns["r"] = (np.mod(columns[n] + 0.4, 2 * np.pi) for n in "qr")
    if hurt == "slow":  # two topics, row by row
        columns["q"][1::2], columns["r"][::2] = np.nan, np.nan
    made = prepare("log", columns, rig)
    for piece in made.pieces:
        there = np.interp(piece.seconds, clean.pieces[0].seconds, clean.pieces[0].effort)
        assert np.abs(there - piece.effort)[piece.use].max() < 0.02 * np.abs(there).max()
    assert hurt == "slow" or any("'r'" in s or "'q'" in s for s in made.said)


def test_a_position_that_stands_but_for_spikes_is_left_out():
    still = log()
    still["q"] = np.full(6000, 1.0)
    still["q"][[1000, 4000]] = [70.0, -40.0]
    with pytest.raises(NothingLeft, match="'q' is constant at 1"):
        prepare("log", still, RIG)


@pytest.mark.parametrize(("origin", "kept"), [("command", True), ("measured", False)])
def test_a_log_of_one_step_of_its_command_is_used(origin, kept):
    """It begins at the switch-on; a measured effort that never changes is a sensor that stands."""
    t = np.arange(0, 4, 2e-3)
    log = {"t": t, "q": t - 0.2 * (1.0 - np.exp(-t / 0.2)), "u": np.full_like(t, 0.5)}
    effort = {"column": "u", "unit": "N·m", "kind": "torque", "origin": origin}
    rig = RigFile.model_validate(description(effort=effort))
    if kept:
        assert prepare("log", log, rig).pieces[0].use.mean() > 0.5
        return
    with pytest.raises(NothingLeft, match=r"'u' is constant at 0\.5"):
        prepare("log", log, rig)
