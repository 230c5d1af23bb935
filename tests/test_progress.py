"""Progress: plain lines where nobody watches, a bar with the time left on a terminal.

A search that may end early says how long it can take at most.
"""

import io
import os
from contextlib import suppress

import pytest

from spirob.cli.commands import trial
from spirob.progress import Progress, SearchProgress, Steps, TimeLeft, clock


def test_elsewhere_one_plain_line_for_each_unit():
    stream = io.StringIO()
    with Progress(["fit", "judge"], stream=stream) as progress:
        for unit in ("fit", "judge"):
            progress.begin(unit)
            progress.done(unit, "unchanged" if unit == "judge" else "")
    first, second = stream.getvalue().splitlines()
    assert first.startswith("fit: ")
    assert first.endswith(" s (1 of 2)")
    assert second == "judge: unchanged (2 of 2)"
    assert "\x1b" not in stream.getvalue()


def on_a_terminal(monkeypatch, colourless):
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.delenv("NO_COLOR", raising=False)
    if colourless:
        monkeypatch.setenv("NO_COLOR", "1")
    leader, follower = os.openpty()
    with (
        open(follower, "w") as stream,
        Progress(["fit", "judge"], {"fit": 3.0, "judge": 60.0}, stream) as progress,
    ):
        progress.begin("fit")
        progress.tell("a line above")
        progress.done("fit")
    seen = b""
    with suppress(OSError):  # the end, once the other side is closed: one read may hold a part only
        while piece := os.read(leader, 100_000):
            seen += piece
    os.close(leader)
    return seen.decode()


def test_on_a_terminal_a_bar_with_the_time_left(monkeypatch):
    seen = on_a_terminal(monkeypatch, colourless=False)
    assert "1:00 left" in seen
    assert "1/2" in seen
    assert "a line above" in seen
    assert "\x1b[38;5;" in seen or "\x1b[3" in seen


def test_no_colours_where_they_are_not_wanted(monkeypatch):
    seen = on_a_terminal(monkeypatch, colourless=True)
    assert "1:00 left" in seen
    assert "\x1b[38;5;" not in seen


def test_the_forecast_uses_last_times_else_the_mean_of_this_run():
    left = TimeLeft(["a", "b", "c"], {"a": 10.0, "b": 20.0})
    assert left.seconds() is None  # nothing tells how long c will be
    left.done("a", 8.0)
    assert left.seconds(in_current=5.0) == pytest.approx(15.0 + 8.0)
    left.done("b", 0.0, worked=False)
    assert left.seconds() == pytest.approx(8.0)
    left.done("c", 8.0)
    assert left.seconds() == 0.0


def test_a_unit_that_overruns_leaves_no_negative_time():
    assert TimeLeft(["a"], {"a": 1.0}).seconds(in_current=9.0) == 0.0


@pytest.mark.parametrize(
    ("seconds", "shown"), [(None, "–:––"), (0.4, "0:00"), (61, "1:01"), (600.2, "10:00")]
)
def test_the_clock(seconds, shown):
    assert clock(seconds) == shown


def test_a_trial_tells_a_line_for_each_case_and_moves_on():
    stream = io.StringIO()
    with Progress(["cogging-0", "none-0"], stream=stream) as progress:
        tell = trial._told(progress)
        tell("1 of 2: none-0: nothing_missing (100%) right")
        tell("a worker was killed; the cases without a result are run again")
    assert stream.getvalue().splitlines() == [
        "1 of 2: none-0: nothing_missing (100%) right",
        "a worker was killed; the cases without a result are run again",
    ]
    assert progress._left._left == ["cogging-0"]
    assert list(progress.taken) == ["none-0"]


def search(tell):
    """Five steps are expected; after the second it is known that there is one more."""
    steps = Steps(tell, 5)
    steps("bare model: 9 %")
    steps("friction: 3 %")
    steps.expect(1)
    steps("friction + cogging: 1 %")
    tell("a note")


def test_each_line_says_how_far_the_search_is():
    said = []
    search(said.append)
    assert [(s.done, s.of) for s in said[:3]] == [(1, 5), (2, 5), (3, 3)]
    assert said[3] == "a note"


def test_more_steps_than_expected_are_no_more_than_all():
    said = []
    steps = Steps(said.append, 1)
    steps("one")
    steps("two")
    assert [(s.done, s.of) for s in said] == [(1, 1), (2, 2)]


def test_elsewhere_plain_lines_and_quiet_none():
    stream = io.StringIO()
    with SearchProgress(stream) as progress:
        search(progress)
    assert stream.getvalue().splitlines()[1:] == [
        "friction: 3 %",
        "friction + cogging: 1 %",
        "a note",
    ]
    silent = io.StringIO()
    with SearchProgress(silent, quiet=True) as progress:
        search(progress)
    assert silent.getvalue() == ""


def test_on_a_terminal_a_bar_with_the_time_left_at_most(monkeypatch):
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr("spirob.progress.time.monotonic", lambda: 60.0)
    leader, follower = os.openpty()
    with open(follower, "w") as stream, SearchProgress(stream) as progress:
        progress._begun = 0.0
        assert progress.left() == "–:––"
        search(progress)
        assert progress.left() == "at most 0:00"
        Steps(progress, 3)("again")
        assert progress.left() == "at most 2:00"
    seen = b""
    with suppress(OSError):
        while piece := os.read(leader, 100_000):
            seen += piece
    os.close(leader)
    assert "a note" in seen.decode()
    assert "1/3" in seen.decode()
