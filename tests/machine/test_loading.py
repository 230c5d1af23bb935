"""A file of one's own is run within bounds, where it lies where it may; else it is a sentence."""

import os
import subprocess
import sys

import pytest

from spirob.cli.main import main
from spirob.errors import ConfigError, DataError, EffectError, MissingLog
from spirob.machine import loading
from spirob.machine.loading import chosen, files, tried
from tests.effects.test_declaration import GOOD

KERNEL = "return -torque * speed"


def written(folder, text, name="own.py"):
    (folder / name).write_text(text)
    return str(folder / name)


def test_a_sound_file_is_run_and_found(tmp_path):
    path = written(tmp_path, GOOD)
    effects = chosen(files(["coulomb_friction", "own.py"], tmp_path))
    assert [e.name() for e in effects] == ["coulomb_friction", "own"]
    assert files(["coulomb_friction"], tmp_path, [path]) == ["coulomb_friction", path]


def test_a_description_names_files_beside_or_below_itself(tmp_path):
    folder = tmp_path / "rig"
    (folder / "below").mkdir(parents=True)
    outside = written(tmp_path, GOOD)
    (folder / "link.py").symlink_to(outside)
    for name in (outside, "../own.py", "link.py", "below/../../own.py", "a\0.py"):
        with pytest.raises(ConfigError, match=r"leads out of|no path"):
            files([name], folder)
    assert files(["below/own.py"], folder) == [str((folder / "below/own.py").resolve())]
    assert files([], folder, [outside]) == [outside]  # by hand from anywhere


@pytest.mark.parametrize(
    ("given", "got"), [("coulomb_friction", "a single one"), (None, "NoneType"), (3, "int")]
)
def test_effects_by_hand_are_a_list(tmp_path, given, got):
    with pytest.raises(ConfigError, match=rf"effects: a list of names and files, got {got}"):
        files([], tmp_path, given)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("import sys\nsys.exit(0)", "fails: SystemExit: 0"),
        ("raise KeyboardInterrupt", "fails: KeyboardInterrupt"),
        ("import os\nos._exit(0)", "ends the process that runs it"),
        ("many = [bytearray(10**8) for _ in range(50)]", "fails: MemoryError"),
        ("x = 1", "defines no effect"),
        (GOOD.replace(KERNEL, "return torque / (speed - speed)"), "kernel fails: ZeroDivision"),
        (GOOD.replace(KERNEL, "raise ValueError('no')"), "kernel fails: "),
        (GOOD.replace(KERNEL, "return absent(speed)"), "nothing that a kernel can call"),
        (GOOD.replace(KERNEL, "return torque, speed"), "kernel fails: "),
        ("import math\n" + GOOD.replace(KERNEL, "return speed * math.nan"), "no finite number"),
    ],
)
def test_a_file_that_fails_is_a_sentence(tmp_path, text, sentence):
    with pytest.raises(EffectError, match=rf"own\.py'.* {sentence}"):
        chosen([written(tmp_path, text)])


def test_a_file_that_never_ends_is_ended(tmp_path, monkeypatch):
    monkeypatch.setattr(loading, "LONGEST", 1)
    path = written(tmp_path, "while True:\n    pass")
    with pytest.raises(EffectError, match=r"does not end in 1 s of computing or \d+ s in all$"):
        tried(path, kernel=True)
    assert main(["effects", "check", path]) == 2


@pytest.mark.parametrize("far", ["speed != 1e9", "speed > 2e4", "speed == 0.123456789"])
def test_a_kernel_that_may_never_end_is_refused_wherever_it_would(tmp_path, capsys, far):
    loop = f"while {far}:\n            torque += 1.0\n        return torque"
    path = written(tmp_path, GOOD.replace(KERNEL, loop))
    with pytest.raises(EffectError, match=r"own\.py': line \d+: `while .* a kernel is a formula"):
        chosen([path])
    assert main(["effects", "check", path]) == 2
    assert "a kernel is a formula" in capsys.readouterr().err


def test_a_script_of_any_form_may_ask(tmp_path):
    """The process apart does not run the script again, which has no guard against it."""
    path = written(tmp_path, GOOD)
    asked = f"from spirob.machine.loading import chosen\nprint(chosen([{path!r}])[0].name())"
    command = [sys.executable, written(tmp_path, asked, "script.py")]
    env = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    said = subprocess.run(command, capture_output=True, text=True, check=True, env=env).stdout
    assert said == "own\n"


def test_names_are_given_once_and_not_the_librarys(tmp_path):
    path = written(tmp_path, GOOD)
    with pytest.raises(EffectError, match="'own' is given twice"):
        chosen([path, path])
    with pytest.raises(EffectError, match="the library has an effect of that name"):
        chosen([written(tmp_path, GOOD, "creep.py")])


def test_what_is_no_file_is_a_sentence(tmp_path):
    os.mkfifo(tmp_path / "pipe.py")
    (tmp_path / "folder.py").mkdir()
    for name, kind in (("pipe.py", DataError), ("folder.py", DataError), ("no.py", MissingLog)):
        with pytest.raises(kind, match=r"no.* effect file"):
            tried(str(tmp_path / name), kernel=True)
