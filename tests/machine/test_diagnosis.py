"""From files to a verdict: what is given is looked at before it is used."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from sklearn.base import clone

from spirob.cli.main import main
from spirob.diagnosis import flexible
from spirob.diagnosis.criteria import Criteria
from spirob.errors import ConfigError, DataError, EffectError, MissingLog
from spirob.machine.description.rig import RigFile
from spirob.machine.diagnosis import diagnose
from spirob.machine.recordings.recording import prepare
from spirob.machine.search import judging, leftovers
from tests.effects.test_declaration import GOOD
from tests.machine.rigs import description

NONE = Criteria(most=0)  # no search


def log(folder, name, seed, size=0.004):
    """A rotor of 1 A·s²/rad with 0.2 A of dry friction on a stroke of about two sizes [rad]."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 6.0, 0.005)
    turn = rng.uniform(2.0, 12.0, 3)[:, None] * t + rng.uniform(0, 6.0, (3, 1))
    rate = np.diff(turn)[:, :1] / 0.005
    q = size * np.sin(turn).sum(0)
    v, a = size * (rate * np.cos(turn)).sum(0), -size * (rate**2 * np.sin(turn)).sum(0)
    u = a + 2.0 * v + 0.2 * np.tanh(v / 1e-4) + rng.normal(0, 0.002, len(t))
    pd.DataFrame({"t": t, "q": q, "u": u}).to_csv(folder / name, index=False)
    return str(folder / name)


@pytest.fixture(autouse=True)
def little_said_of_what_is_left(monkeypatch):
    """No test here asks what is left: no law is composed of it, and few trees learn it."""
    monkeypatch.setattr(judging, "composed", lambda *of: None)
    few = flexible.tree().set_params(max_iter=5)
    monkeypatch.setattr(flexible, "tree", lambda: clone(few))
    monkeypatch.setattr(leftovers, "tree", lambda: clone(few))


@pytest.fixture
def rig(tmp_path):
    def write(**changes):
        path = tmp_path / "rig.yaml"
        path.write_text(yaml.safe_dump(description(**changes)))
        return str(path)

    return write


def test_a_motion_too_small_for_some_effects_is_diagnosed_with_the_others(tmp_path, rig):
    """And a file of one's own beside the description is run, which the repairs say."""
    (tmp_path / "own.py").write_text(GOOD)
    logs = [log(tmp_path, f"{k}.csv", k) for k in range(3)]
    document = diagnose(rig(effects=["own.py"]), logs[:2], logs[2:], NONE).document
    assert document["excluded"]["cogging"].startswith("the motion is too small to show it")
    assert document["repairs"][0] == f"{tmp_path / 'own.py'}: was run, as an effect of your own."


def test_a_log_without_rows_is_left_out_and_said(tmp_path, rig):
    logs = [log(tmp_path, f"{k}.csv", k) for k in range(3)]
    (tmp_path / "empty.csv").write_text("t,q,u\n")
    found = diagnose(rig(), [*logs[:2], tmp_path / "empty.csv"], logs[2:], NONE)
    assert (
        "it takes a line of names, and rows; the log is left out." in found.document["repairs"][0]
    )
    with pytest.raises(DataError, match="it takes a line of names, and rows"):
        diagnose(rig(), [tmp_path / "empty.csv"], logs[2:], NONE)


def test_numbers_of_numpy_in_a_description_are_numbers(tmp_path):
    logs = [log(tmp_path, f"{k}.csv", k) for k in range(3)]
    about = {"nominal": np.float32(1.0), "low": np.float64(0.1), "high": np.int64(10)}
    told = description(fit={"inertia": about, "viscous": {**about, "low": 0}})
    found = diagnose(told, logs[:2], logs[2:], NONE)
    assert "high: 10" in found.sources.config


@pytest.mark.parametrize(
    ("rig", "train", "settings", "said"),
    [
        (None, [], None, "rig: a file or a mapping of keys, got NoneType"),
        (description(), [{"t": [0.0]}], None, r"train\[0\]: a file or a DataFrame, got dict"),
        (description(), None, None, "train: a list of logs, got NoneType"),
        (description(), [], 3, "settings: Criteria, got int"),
        (description(), [], None, "at least one training log"),
    ],
)
def test_what_is_of_another_type_is_a_sentence(rig, train, settings, said):
    with pytest.raises((ConfigError, DataError), match=said):
        diagnose(rig, train, [], settings)


def test_bounds_are_set_free_before_logs_are_said_to_differ(tmp_path, rig):
    """Three logs of one machine whose inertia is five times what the description allows."""
    logs = [log(tmp_path, f"{k}.csv", k) for k in range(3)]
    narrow = {
        "inertia": {"nominal": 0.1, "low": 0.01, "high": 0.2},
        "viscous": {"nominal": 1.0, "low": 0.0, "high": 5.0},
    }
    found = diagnose(rig(fit=narrow), logs[:2], logs[2:], NONE)
    repairs = found.document["repairs"]
    assert not any("differ by a number of their own" in text for text in repairs)
    assert any("inertia ended at its bound, so it was set free: 1.0" in text for text in repairs)


def test_a_log_is_given_once_whatever_its_name(tmp_path, rig):
    logs = [log(tmp_path, f"{k}.csv", k) for k in range(2)]
    table = pd.read_csv(logs[0])
    table.to_csv(tmp_path / "copy.tsv", sep="\t", index=False)
    table[100:900].to_csv(tmp_path / "part.csv", index=False)
    for other in ("0.csv", "copy.tsv", "part.csv"):
        with pytest.raises(ConfigError, match=r"0\.csv; a log is fitted or held out, once"):
            diagnose(rig(), logs, [tmp_path / other], NONE)


def test_a_description_says_how_the_search_decides(tmp_path, rig):
    """Above the size of its friction, or with no effect at all, none is named."""
    logs = [log(tmp_path, f"{k}.csv", k) for k in range(3)]
    assert diagnose(rig(), logs[:2], logs[2:]).findings
    for criteria in ({"floor": 0.9}, {"most": 0}):
        assert not diagnose(rig(criteria=criteria), logs[:2], logs[2:]).findings


def test_what_cannot_be_used_is_a_sentence_and_no_result(tmp_path, rig, capsys):
    good, out = log(tmp_path, "0.csv", 0), tmp_path / "out"
    (tmp_path / "exits.py").write_text("raise SystemExit(0)")
    given = ["diagnose", "--out", str(out), "--rig", rig(), "--train", good]
    for more, sentence in [
        (["--train", str(tmp_path)], "is a folder, and none that holds a ROS 2 bag"),
        (["--train", "/dev/zero"], "is a pipe or a device"),
        (["--test", str(tmp_path / "none.csv")], "there is no such log"),
        (["--train", "a\udcff.csv"], "not UTF-8"),
        (["--out", "a\udcff"], "not UTF-8"),
        (["--out", f"{good}/a/b"], "is a file, not a folder"),
        (["--effects", str(tmp_path / "exits.py")], "fails: SystemExit"),
        (["--effects", "gravity_waves"], "no effect 'gravity_waves'"),
    ]:
        assert main([*given, *more]) == 2
        assert sentence in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("given", ["../other.dbc", "/etc/hostname", "link.dbc"])
def test_a_dbc_file_lies_beside_or_below_the_description(tmp_path, given):
    folder = tmp_path / "rig"
    folder.mkdir()
    (tmp_path / "other.dbc").write_text("secret")
    (folder / "link.dbc").symlink_to(tmp_path / "other.dbc")
    (folder / "rig.yaml").write_text(yaml.safe_dump(description(dbc=given)))
    (folder / "a.log").write_text("(1.0) can0 100#00\n")
    with pytest.raises(ConfigError, match=f"dbc: '{given}' leads out of"):
        diagnose(folder / "rig.yaml", [folder / "a.log"], [])


def test_from_python_the_same_are_errors(tmp_path, rig):
    good = log(tmp_path, "0.csv", 0)
    for wrong, kind in (("a\0b.csv", DataError), (tmp_path / "none.csv", MissingLog)):
        with pytest.raises(kind):
            diagnose(rig(), [good, wrong], [], NONE)
    with pytest.raises(EffectError, match="no effect"):
        diagnose(rig(), [good], [], NONE, effects=["no_such"])
    with pytest.raises(ConfigError, match="leads out of"):
        diagnose(rig(effects=["/tmp/own.py"]), [good], [], NONE)


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({"rest_speed": 1e15}, ConfigError),
        ({"fit": {"inertia": {"nominal": 1.0, "low": 1.0, "high": 1.0 + 1e-15}}}, DataError),
        ({"effort": {"column": "u", "unit": "V", "kind": "voltage", "factor": 1e15}}, ConfigError),
    ],
)
def test_numbers_that_cannot_be_meant_are_a_sentence(tmp_path, rig, changes, kind):
    logs = [log(tmp_path, f"{k}.csv", k) for k in range(2)]
    with pytest.raises(kind):
        diagnose(rig(**changes), logs[:1], logs[1:], NONE)


@pytest.mark.parametrize("wave", ["cogging", "torque_ripple"])
def test_a_wave_that_was_named_can_be_told(tmp_path, rig, wave):
    """The ratios of its further waves move nothing before these have an amplitude."""
    logs = [log(tmp_path, f"{k}.csv", k, size=2.0) for k in range(3)]
    found = diagnose(rig(effects=[wave, "coulomb_friction"]), logs[:2], logs[2:], settings=NONE)
    assert "coulomb_friction.coulomb_torque" in found.document["model"]["fitted"]["names"]


def other(kind):
    """A log in which nothing is left, of one kind or another."""
    t = np.arange(0, 6, 5e-3)
    nothing = np.full(len(t), np.nan)
    columns = {
        "no effort": {"t": t, "q": np.sin(t), "u": nothing},
        "no position": {"t": t, "q": nothing, "u": np.sin(t)},
        "one step": {"t": t, "q": np.where(t < 3, 0.0, 1.0), "u": np.sin(9.1 * t)},
        "no rows": {"t": [], "q": [], "u": []},
    }
    return pd.DataFrame(columns[kind])


def test_logs_in_which_nothing_is_left_are_left_out_beside_good_ones(tmp_path, rig):
    logs = [log(tmp_path, f"{k}.csv", k) for k in range(3)]
    bad = [other(kind) for kind in ("no effort", "no position", "one step", "no rows")]
    found = diagnose(rig(), [*logs[:2], *bad], logs[2:], NONE)
    assert found.verdict == diagnose(rig(), logs[:2], logs[2:], NONE).verdict
    assert sum("the log is left out" in note for note in found.notes) == len(bad)


def test_a_description_in_utf_16_is_read_and_kept(tmp_path, rig):
    logs = [log(tmp_path, f"{k}.csv", k) for k in range(3)]
    text = Path(rig()).read_text()
    wide = tmp_path / "wide.yaml"
    wide.write_bytes(text.encode("utf-16"))
    assert diagnose(wide, logs[:2], logs[2:], NONE).sources.config == text


def test_a_piece_that_stands_at_one_effort_saturates_nothing():
    t = np.arange(0, 12, 5e-3)
    stands = t > 6
    q = np.where(stands, np.sin(6.0), np.sin(t))
    u = np.where(stands, 0.1, np.cos(3.0 * t))
    t = np.where(stands, t + 3.0, t)
    found = prepare("log", {"t": t, "q": q, "u": u}, RigFile.model_validate(description()))
    assert not any("saturates" in text for text in found.said)
    assert any("stand" in text for text in found.said)
