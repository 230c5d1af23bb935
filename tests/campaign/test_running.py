"""The campaign's file: a line each, kept when it is stopped; and a tiny campaign to the end."""

import json

import pytest

from spirob.campaign import running
from spirob.campaign.case import Case
from spirob.cli.main import main
from spirob.errors import DataError

CASES = [Case("bench", "none", seed) for seed in range(3)]


def line(case):
    return {"simulator": case.simulator, "kind": case.kind, "seed": case.seed, "value": case.seed}


@pytest.fixture
def played(monkeypatch):
    """Names of the cases that were played."""
    names = []

    def result(case):
        names.append(case.name)
        return line(case)

    monkeypatch.setattr(running, "result", result)
    return names


def test_what_is_there_is_kept_and_a_torn_end_is_played_again(tmp_path, played):
    path = tmp_path / "campaign.jsonl"
    whole = json.dumps(line(CASES[0]) | {"value": 7}) + "\n"
    path.write_text(whole + json.dumps(line(CASES[1]))[:20])
    results = running.play(CASES, path, workers=1)
    assert played == [CASES[1].name, CASES[2].name]
    assert [r["value"] for r in results] == [7, 1, 2]
    assert path.read_text().startswith(whole)
    assert [json.loads(text)["seed"] for text in path.read_text().splitlines()] == [0, 1, 2]
    assert running.play(CASES, path, workers=1) == results
    assert len(played) == 2


def test_each_result_is_on_disk_before_the_next_is_played(tmp_path, played):
    path = tmp_path / "campaign.jsonl"

    def stop(case, one):
        assert json.loads(path.read_text().splitlines()[-1]) == one
        if case == CASES[1]:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        running.play(CASES, path, 1, stop)
    assert list(running.known(path)) == [CASES[0].name, CASES[1].name]


def test_another_file_is_not_written_over(tmp_path, played):
    path = tmp_path / "notes.txt"
    path.write_text("dear diary\nnothing happened\n")
    with pytest.raises(DataError, match="line 1 is no result"):
        running.play(CASES, path, workers=1)
    assert path.read_text().startswith("dear diary")


@pytest.mark.parametrize(
    "wrong",
    [
        ["--kinds", "gremlins"],
        ["--kinds", "cogging+torque_ripple"],
        ["--kinds", "backlash", "--simulators", "bench"],
        ["--simulators", "gazebo"],
        ["--pairs"],
        ["--seeds", "5:5"],
    ],
)
def test_bad_choices_are_a_sentence(wrong, capsys, tmp_path):
    assert main(["trial", "--rigs", *wrong, "--out", str(tmp_path / "c.jsonl")]) == 2
    assert wrong[0] in capsys.readouterr().err


@pytest.mark.parametrize("given", [["--disturbed"], ["--simulators", "bench"]])
def test_what_axes_alone_have_is_refused_of_robots(given, capsys, tmp_path):
    assert main(["trial", *given, "--out", str(tmp_path / "c.jsonl")]) == 2
    assert f"{given[0]}: with --rigs only" in capsys.readouterr().err


def test_a_tiny_campaign_is_played_to_its_table(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("spirob.campaign.case.RATES", (200.0,))
    monkeypatch.setattr("spirob.campaign.case.length_of", lambda rate, rng: 6.0)
    path, summary = tmp_path / "campaign.jsonl", tmp_path / "table.json"
    asked = ["trial", "--rigs", "--simulators", "bench", "--kinds", "quadratic_drag", "none"]
    asked += ["--seeds", "2:3", "--workers", "1", "--out", str(path), "--json", str(summary)]
    assert main(asked) == 0
    said = capsys.readouterr()
    lines = [json.loads(text) for text in path.read_text().splitlines()]
    assert {one["kind"] for one in lines} == {"quadratic_drag", "none"}
    for one in lines:
        assert one["refused"] == one["crashed"] == ""
        assert one["features"]["considered"] > 5
        assert one["said"]["verdict"] in {"named", "undecided", "unknown", "nothing_missing"}
    assert "quadratic_drag hidden" in said.err
    assert json.loads(summary.read_text())["one"]["bench"]["n"] == 1
    assert said.out.splitlines()[0].startswith("hidden")
    assert main(asked) == 0
    assert len(path.read_text().splitlines()) == 2
