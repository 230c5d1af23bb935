"""Whatever a path leads to is a file that can be read, or a sentence; nothing waits for ever.

A file that is written appears whole or not at all.
"""

import os

import pytest

from spirob.errors import DataError, MissingLog
from spirob.files import content, may_hold_results, replacing, write_bytes, write_text


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


def test_content_arrives_under_the_name(tmp_path):
    write_text(tmp_path / "new" / "a.txt", "ä\n")
    write_bytes(tmp_path / "b", b"\x00")
    assert (tmp_path / "new" / "a.txt").read_bytes() == "ä\n".encode()
    assert (tmp_path / "b").read_bytes() == b"\x00"


def test_a_name_that_is_no_text_can_be_written(tmp_path):
    write_text(tmp_path / "a.txt", os.fsdecode(b"log\xff.csv"))
    assert (tmp_path / "a.txt").read_text() == "log?.csv"


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "a.txt"
    write_text(target, "old")
    with pytest.raises(ZeroDivisionError), replacing(target) as temporary:
        temporary.write_text("half")
        raise ZeroDivisionError
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_the_temporary_file_lies_in_the_same_folder(tmp_path):
    with replacing(tmp_path / "a") as temporary:
        assert temporary.parent == tmp_path
        temporary.write_bytes(b"")


@pytest.mark.parametrize("place", ["file", "file/a", "link", "link/a", "/proc/none/a", 300 * "a"])
def test_a_folder_that_cannot_hold_results_is_told_by_trying(tmp_path, place):
    (tmp_path / "file").touch()
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    with pytest.raises(OSError, match=r"is a file, not a folder|cannot be written|too long"):
        may_hold_results(tmp_path / place)


def test_trying_a_folder_for_results_leaves_nothing(tmp_path):
    may_hold_results(tmp_path)
    may_hold_results(tmp_path / "a" / "b")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_in_which_nothing_can_be_written_is_told(tmp_path, monkeypatch):
    def full(**given):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("spirob.files.tempfile.TemporaryDirectory", full)
    with pytest.raises(OSError, match="cannot be written: No space left"):
        may_hold_results(tmp_path / "a")
