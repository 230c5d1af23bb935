"""The command: quick to help, exact in its exit codes, errors in one sentence."""

import argparse
import json
import os
import re
import subprocess
import sys
import time

import pandas as pd
import pytest
import yaml

from spirob.cli import main as command
from spirob.cli.main import main
from tests.effects.effects import TEMPLATE
from tests.effects.test_declaration import GOOD
from tests.machine.rigs import damper


def test_help_is_there_within_half_a_second():
    def once():
        begin = time.perf_counter()
        asked = [sys.executable, "-m", "spirob.cli.main", "--help"]
        answer = subprocess.run(asked, capture_output=True, text=True, check=True)
        assert "diagnose" in answer.stdout
        return time.perf_counter() - begin

    assert any(once() <= 0.5 for _ in range(10))  # the machine may be busy


def test_every_subcommand_has_a_help(capsys):
    for module in command.subcommands():
        with pytest.raises(SystemExit) as stopped:
            main([command.name_of(module), "--help"])
        assert stopped.value.code == 0
        assert module.HELP
    assert capsys.readouterr().out


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rig")
    case = damper(1003)
    (folder / "rig.yaml").write_text(yaml.safe_dump(case.rig))
    for name, columns in {"a": case.train[0], "b": case.train[1], "c": case.test}.items():
        pd.DataFrame(columns).to_csv(folder / f"{name}.csv", index=False)
    return folder


@pytest.fixture(scope="module")
def done(rig):
    out = rig / "out"
    logs = [
        "--train",
        str(rig / "a.csv"),
        "--train",
        str(rig / "b.csv"),
        "--test",
        str(rig / "c.csv"),
    ]
    code = main(["diagnose", "--rig", str(rig / "rig.yaml"), *logs, "--out", str(out), "--quiet"])
    return code, json.loads((out / "diagnosis.json").read_text()), (out / "index.html").read_text()


def test_diagnose_writes_what_was_promised(done):
    code, document, _ = done
    assert code == 0
    assert document["verdict"] == "named"
    (effect,) = document["effects"]
    assert effect["name"] == "coulomb_friction"
    level = effect["parameters"]["coulomb_torque"]
    assert level["unit"] == "N"
    assert level["low"] < level["value"] < level["high"]
    assert {"name", "probability", "equivalents", "parameters"} <= set(effect)
    for candidate in document["candidates"]:
        assert {"name", "probability", "heldout_rmse"} <= set(candidate)
    for rung in document["ladder"]:
        assert {"effects", "train", "test"} <= set(rung)
        assert set(rung["train"]) == set(rung["test"]) == {"mae", "rmse", "r2"}
        for role in ("train", "test"):
            assert set(rung["interval"][role]) == {"mae", "rmse", "r2"}
            for name, (low, high) in rung["interval"][role].items():
                assert low < rung[role][name] < high
    keys = {"noise_floor", "atlas", "next_experiment", "explanation", "unit"}
    assert keys <= set(document)


def test_the_page_stands_alone_and_says_the_verdict_first(done):
    _, document, page = done
    assert page.index(document["sentence"]) < page.index("Comparison</h2>")
    assert "default-src 'none'" in page
    assert "Effects that this rig cannot show" in page
    links = set(re.findall(r'href="#([^"]+)"', page))
    assert links <= set(re.findall(r'id="([^"]+)"', page))
    assert len(page.encode()) < 8_000_000


def test_one_log_is_divided_and_that_is_said(rig, tmp_path, capsys):
    given = ["--rig", str(rig / "rig.yaml"), "--train", str(rig / "a.csv"), "--out", str(tmp_path)]
    assert main(["diagnose", *given]) == 0
    assert "No held-out log was given" in capsys.readouterr().err
    assert "No held-out log was given" in (tmp_path / "index.html").read_text()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--rig", "nowhere.yaml", "--train", "a.csv"], "no such rig description"),
        (["--rig", "rig.yaml", "--train", "nowhere.csv"], "no such log"),
        (["--rig", "rig.yaml", "--train", "rig.yaml"], "no known kind of log"),
    ],
)
def test_a_mistake_is_one_sentence_and_exit_code_2(rig, tmp_path, capsys, arguments, sentence):
    paths = [a if a.startswith("--") else str(rig / a) for a in arguments]
    assert main(["diagnose", *paths, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_stopping_by_hand_is_130(capsys):
    def stopped(chosen):
        raise KeyboardInterrupt

    assert command._guarded(argparse.Namespace(run=stopped)) == 130
    assert "Traceback" not in capsys.readouterr().err


def test_effects_are_listed_shown_begun_and_checked(tmp_path, capsys):
    assert main(["effects", "list"]) == 0
    assert "coulomb_friction" in capsys.readouterr().out
    assert main(["effects", "show", "cogging"]) == 0
    assert "Magnets prefer" in capsys.readouterr().out
    own = tmp_path / "brush_bounce.py"
    assert main(["effects", "new", str(own)]) == 0
    assert main(["effects", "check", str(own)]) == 0
    assert "brush_bounce" in capsys.readouterr().out
    assert main(["effects", "new", str(own)]) == 2
    own.write_text(own.read_text().replace('"motor.torque"', '"motor.nowhere"'))
    assert main(["effects", "check", str(own)]) == 2
    assert "motor.nowhere" in capsys.readouterr().err
    assert main(["effects", "show", "phlogiston"]) == 2


@pytest.mark.parametrize(
    "at_the_end",
    ["atexit.register(os._exit, 0)", "weakref.finalize(os, os._exit, 0)"],
)
def test_no_effect_of_ones_own_turns_a_refusal_into_success(rig, tmp_path, at_the_end):
    own = tmp_path / "own.py"
    own.write_text(f"{TEMPLATE.read_text()}\nimport atexit, os, weakref\n{at_the_end}\n")
    logs = ["--train", str(rig / "a.csv"), "--train", str(rig / "a.csv")]
    given = ["--rig", str(rig / "rig.yaml"), *logs, "--effects", str(own), "--out", str(tmp_path)]
    asked = [sys.executable, "-m", "spirob.cli.main", "diagnose", *given]
    answer = subprocess.run(asked, capture_output=True, text=True, check=False)
    assert answer.returncode == 2
    assert answer.stderr.startswith("spirob: ")
    assert answer.stderr.count("\n") == 1


@pytest.mark.parametrize("cached", [True, False])
@pytest.mark.parametrize("kernel", ["return torque / (speed - speed)", "return -torque * speed"])
def test_a_refusal_leaves_no_folder_behind(rig, tmp_path, cached, kernel):
    """Neither of processes apart nor of what is generated where the cache cannot be written."""
    text = GOOD.replace("return -torque * speed", kernel)
    (tmp_path / "own.py").write_text(text)
    (tmp_path / "a.npz").write_bytes(b"no archive")
    (tmp_path / "tmp").mkdir()
    (tmp_path / "file").write_text("in which no folder can be made")
    given = ["--rig", str(rig / "rig.yaml"), "--train", str(tmp_path / "a.npz")]
    given += ["--effects", str(tmp_path / "own.py"), "--out", str(tmp_path / "out")]
    env = {**os.environ, "TMPDIR": str(tmp_path / "tmp")}
    env["XDG_CACHE_HOME"] = str(tmp_path / ("cache" if cached else "file"))
    asked = [sys.executable, "-m", "spirob.cli.main", "diagnose", *given]
    answer = subprocess.run(asked, capture_output=True, text=True, check=False, env=env)
    assert answer.returncode == 2
    assert answer.stderr.count("\n") == 1
    assert list((tmp_path / "tmp").iterdir()) == []
