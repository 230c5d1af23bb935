"""Whatever a path leads to is a file that can be read, or a sentence; nothing waits for ever."""

import os

import pytest

from spirob.errors import DataError, MissingLog
from spirob.given_file import content


def test_a_file_is_read_as_far_as_it_may_go(tmp_path):
    path = tmp_path / "a file\u00a0of mine.txt"
    path.write_bytes(b"1234")
    assert content(path, "note", 4) == b"1234"
    with pytest.raises(DataError, match="more than 0 KiB is no note"):
        content(path, "note", 3)


def test_what_is_no_file_is_a_sentence(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "empty").symlink_to("nowhere")
    for name, kind, sentence in [
        ("absent", MissingLog, "no such note"),
        ("empty", MissingLog, "no such note"),
        ("pipe/below", MissingLog, "no such note"),
        ("pipe", DataError, "a pipe or a device"),
        ("/dev/zero", DataError, "a pipe or a device"),
        (".", DataError, "is a folder"),
        ("loop", DataError, "cannot be read"),
        ("n" * 5000, DataError, "cannot be read"),
        ("a\0b", DataError, "holds no NUL"),
        (os.fsdecode(b"\xff.csv"), DataError, "not UTF-8"),
    ]:
        with pytest.raises(kind, match=sentence):
            content(tmp_path / name, "note", 100)


def test_a_file_that_may_not_be_read_is_a_sentence(tmp_path, monkeypatch):
    (tmp_path / "closed").write_bytes(b"1")
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # root may read anything
    with pytest.raises(DataError, match="may not be read"):
        content(tmp_path / "closed", "note", 100)
