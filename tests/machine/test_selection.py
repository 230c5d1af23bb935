"""One log under several names is found by its rows, and of a very long one a part is used."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from spirob.errors import ConfigError, DataError
from spirob.logs.readers.columns import from_frame
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.filtering import BELOW, possible_cutoff
from spirob.machine.recordings.recording import Recording, of_table, prepare
from spirob.machine.recordings.selection import (
    MOST_ROWS,
    ROOM,
    STRETCH,
    each_once,
    ends_aside,
    filtered_alike,
    in_stretches,
)
from tests.machine.rigs import description

COLUMNS = ["q", "u"]


def log(seed, rows=500):
    rng = np.random.default_rng(seed)
    q, u = rng.normal(size=(2, rows))
    return {"t": np.arange(rows) * 0.01, "q": q, "u": u}


def test_logs_of_their_own_pass():
    each_once([("a", log(1)), ("b", log(2)), ("c", log(3, 100))], COLUMNS)


def test_a_copy_is_found_even_with_another_clock():
    copy = log(1) | {"t": log(1)["t"] + 7.0, "more": np.zeros(500)}
    with pytest.raises(ConfigError, match="b: holds the rows of a; a log is fitted or held out"):
        each_once([("a", log(1)), ("b", copy)], COLUMNS)


@pytest.mark.parametrize("part", [slice(0, 100), slice(200, 400), slice(499, 500)])
def test_a_stretch_of_another_log_is_found_in_any_order(part):
    cut = {name: values[part] for name, values in log(1).items()}
    for logs in ([("a", log(1)), ("b", cut)], [("b", cut), ("a", log(1))]):
        if len(cut["q"]) == 1:  # a single row says nothing of a motion
            each_once(logs, COLUMNS)
            continue
        with pytest.raises(ConfigError, match="b: is a part of a"):
            each_once(logs, COLUMNS)


def test_what_stands_or_lacks_a_column_is_judged_elsewhere():
    still = {"q": np.zeros(50), "u": np.zeros(50)}
    each_once([("a", still), ("b", still), ("c", {"q": np.arange(9.0)})], COLUMNS)


def recording(seconds, rate):
    t = np.arange(0, seconds, 1.0 / rate)
    rig = RigFile.model_validate(description(filter={"cutoff": 0.1 * rate}))
    columns = {"t": t, "q": np.sin(0.7 * t) + 0.1 * np.sin(1.9 * t), "u": np.cos(0.7 * t)}
    return prepare(f"{seconds} s", columns, rig)


def test_of_a_long_log_stretches_are_used_evenly_along_all_of_it():
    whole = recording(1500, 200.0)
    (used,), (said,) = in_stretches([whole])
    rows = sum(int(np.ptp(np.flatnonzero(p.use))) + 1 for p in whole.pieces)
    among = -(-rows // MOST_ROWS)
    assert sum(len(p.q) for p in used.pieces) <= MOST_ROWS
    begins = np.array([p.seconds[0] for p in used.pieces])
    assert np.allclose(np.diff(begins), among * STRETCH, atol=0.01)
    assert used.pieces[-1].seconds[-1] > whole.pieces[0].seconds[-1] - among * STRETCH
    piece, (all_of_it,) = used.pieces[3], whole.pieces
    first = int(np.searchsorted(all_of_it.seconds, piece.seconds[0]))
    for name in ("seconds", "q", "v", "a", "effort", "raw", "use"):
        same = getattr(all_of_it, name)[first : first + len(piece.q)]
        assert np.array_equal(getattr(piece, name), same)
    assert said.startswith(
        f"1500 s: {rows} rows are more than a search needs; 10 s of each {among * STRETCH:g} s"
    )


def test_of_long_logs_whose_ends_are_held_out_the_ends_are_used():
    logs = [recording(110, 500.0) for _ in range(3)]
    kept, held, _ = ends_aside(logs)
    for part in (kept, held):
        assert sum(len(p.q) for r in part for p in r.pieces) > MOST_ROWS
        used, _ = in_stretches(part)
        rows = sum(int(p.use.sum()) for r in used for p in r.pieces)
        assert [r.name for r in used] == [r.name for r in part]
        assert 0.4 * MOST_ROWS < rows <= MOST_ROWS


@pytest.mark.parametrize(("moves", "begins"), [(40.0, 28.0), (26.0, 20.0), (4.0, 20.0)])
def test_an_end_that_is_kept_aside_holds_a_part_of_the_motion(moves, begins):
    """Of 40 s the last 28 to 40 s, or from where 30 % of the way is left, half of all at most."""
    t = np.arange(0.0, 40.0, 0.01)
    q = np.where(t < moves, np.sin(4.0 * t), np.sin(4.0 * moves))
    rig = RigFile.model_validate(description(rows={"standstill": "keep"}))
    kept, held, _ = ends_aside([prepare("log", {"t": t, "q": q, "u": np.cos(4.0 * t)}, rig)])
    (piece,) = held[0].pieces
    assert piece.seconds[piece.use][0] == pytest.approx(begins, abs=1.0)
    assert kept[0].pieces[0].seconds[kept[0].pieces[0].use][-1] < piece.seconds[piece.use][0]


def test_logs_that_a_search_can_keep_are_used_as_they_are():
    logs = [recording(20, 200.0), recording(30, 200.0)]
    assert in_stretches(logs) == (logs, [])


def test_a_time_without_a_unit_needs_dates():
    t = np.arange(0, 10, 0.01)
    columns = {"t": t, "q": np.sin(3 * t), "u": np.cos(3 * t)}
    rig = RigFile.model_validate(description(time={"column": "t"}))
    with pytest.raises(DataError, match=r"plain: time\.unit: 't' holds numbers; known: "):
        of_table(from_frame(pd.DataFrame(columns), "plain"), rig)
    stamps = pd.to_datetime(1e9 * t.round(2), unit="ns")
    objects = columns["u"].astype(object)
    spans = (stamps - stamps[0]).astype(object)
    for times in (stamps, stamps.tz_localize("Europe/Berlin"), stamps.astype(object), spans):
        dated = from_frame(pd.DataFrame({**columns, "t": times, "u": objects}), "dated")
        np.testing.assert_allclose(dated.column("t"), t, atol=1e-6)
        assert of_table(dated, rig).period == pytest.approx(0.01)


OPEN = RigFile.model_validate(description(filter={}))


def swinging(name, seconds, tone):
    """A swing of an inertia with an encoder's noise, whose usual cutoff is that of its tone."""
    t = np.arange(0, seconds, 5e-3)
    q = np.sin(2 * np.pi * tone * t) + 0.003 * np.random.default_rng(0).normal(size=len(t))
    return {"t": t, "q": q, "u": -np.sin(2 * np.pi * tone * t), "name": name}


def read(log, cutoff):
    return prepare(log["name"], {k: v for k, v in log.items() if k != "name"}, OPEN, None, cutoff)


SLOW = [swinging("a", 40.0, 0.1), swinging("b", 30.0, 0.1)]


def test_a_cutoff_that_nobody_gave_leaves_a_short_log_room():
    fast = swinging("fast", 4.0, 0.5)
    own = [read(log, None).cutoff for log in (*SLOW, fast)]
    assert max(own[:2]) < ROOM / 4.0 < own[2]
    for train, test in (([*SLOW, fast], SLOW[:1]), (SLOW, [fast])):
        logs, held = filtered_alike(read, train, test)
        assert {r.name for r in (*logs, *held)} == {"a", "b", "fast"}
        assert {round(r.cutoff, 6) for r in (*logs, *held)} == {round(ROOM / 4.0, 6)}
        assert not any("left out" in text for text in logs[0].said)


def test_the_common_cutoff_passes_most_of_each_log_s_motion():
    """A slow log's noise asks for less than a fast one's motion."""
    fast = swinging("fast", 40.0, 5.0)
    low, high = (read(log, None).cutoff for log in (SLOW[0], fast))
    assert low < 5.0 < high
    logs, _ = filtered_alike(read, [*SLOW, fast], SLOW[:1])
    assert [r.name for r in logs] == ["a", "b", "fast"]
    np.testing.assert_allclose([r.cutoff for r in logs], 5.0 / BELOW, rtol=0.01)


def stood_in(log, cutoff):
    """As a log of so many seconds with a usual cutoff of its own is read."""
    name, seconds, own = log
    cutoff = possible_cutoff(name, cutoff, own, seconds, 0.01, [])
    return Recording(name, 0.01, cutoff, 1, [SimpleNamespace(q=np.zeros(round(100 * seconds)))], [])


@pytest.mark.parametrize(("train", "test"), [([2, 0, 1], [1]), ([0, 1], [2, 1])])
def test_a_log_that_no_cutoff_of_a_log_leaves_room_is_left_out_in_a_true_sentence(train, test):
    logs = [("a", 40.0, 0.5), ("b", 40.0, 0.7), ("brief", 4.0, 0.6)]
    fitted, held = filtered_alike(stood_in, [logs[k] for k in train], [logs[k] for k in test])
    assert [r.name for r in fitted] == ["a", "b"]
    assert [r.name for r in held] == ["b"]
    assert {r.cutoff for r in (*fitted, *held)} == {0.7}
    assert fitted[0].said == [
        "brief: too short for the filter of the other logs, of 0.7 Hz; "
        "9.4 periods of it are 13.4 s; the log is left out."
    ]


def test_a_cutoff_that_was_given_stays():
    given = OPEN.model_copy(update={"filter": OPEN.filter.model_copy(update={"cutoff": 1.0})})

    def by(log, cutoff):
        columns = {k: v for k, v in log.items() if k != "name"}
        return prepare(log["name"], columns, given, None, cutoff)

    with pytest.raises(DataError, match=r"fast: filter.cutoff of 1 Hz leaves nothing of 4 s"):
        filtered_alike(by, SLOW, [swinging("fast", 4.0, 0.5)])
