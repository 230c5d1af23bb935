"""What cannot be written is told in a sentence, from Python as on the command line."""

import pandas as pd
import pytest

from spirob.cli import main as command
from spirob.errors import DataError
from spirob.files import may_hold_results
from spirob.machine.result import Diagnosis

EMPTY = Diagnosis({}, pd.DataFrame(), {}, "", pd.DataFrame())


@pytest.mark.parametrize("place", ["file", "file/a", "/proc/none/a", 300 * "a", "a\0b"])
def test_a_folder_that_cannot_hold_results_is_a_sentence(tmp_path, place):
    (tmp_path / "file").touch()
    with pytest.raises(DataError, match=r"not a folder|cannot be written|too long|no NUL") as told:
        EMPTY.save(tmp_path / place)
    assert "\n" not in str(told.value)


def test_the_command_and_save_say_the_same(tmp_path, capsys):
    (tmp_path / "file").touch()

    def run(chosen):
        may_hold_results(tmp_path / "file")

    assert command._guarded(command.argparse.Namespace(run=run)) == 2
    with pytest.raises(DataError) as told:
        EMPTY.save(tmp_path / "file")
    assert capsys.readouterr().err == f"spirob: {told.value}\n"


def test_no_room_in_the_midst_of_writing_is_a_sentence(tmp_path, monkeypatch):
    def full(path, content):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr("spirob.files.write_bytes", full)
    with pytest.raises(DataError, match=r"diagnosis\.json: No space left on device"):
        EMPTY.save(tmp_path / "a")
