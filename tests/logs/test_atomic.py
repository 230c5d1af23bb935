"""A file appears whole or not at all."""

import os

import pytest

from spirob.logs.atomic import replacing, write_bytes, write_text


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
