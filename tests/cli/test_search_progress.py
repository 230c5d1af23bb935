"""A search that may end early says how long it can take at most."""

import io
import os
from contextlib import suppress

from spirob.cli.progress import SearchProgress
from spirob.progress import Steps


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
    monkeypatch.setattr("spirob.cli.progress.time.monotonic", lambda: 60.0)
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
