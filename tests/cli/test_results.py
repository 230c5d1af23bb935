"""`compare`, `report` and `benchmark`: what they print and write from results that are there."""

import json
import shutil
import webbrowser

import pytest

from spirob import benchmark
from spirob.cli.main import main
from tests.report.synthetic import TRIALS, write_run


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    root = write_run(tmp_path_factory.mktemp("project"))
    (root / "pipeline").mkdir()
    (root / "dvc.yaml").write_text("stages: {}\n")
    (root / "params.yaml").write_text("overrides: []\n")
    return root


def test_compare_has_a_line_for_each_motor_with_units(project, capsys):
    assert main(["compare", "--as-is", "--project", str(project)]) == 0
    head, *rows = capsys.readouterr().out.splitlines()
    assert all(unit in head for unit in ("[mA]", "[mm]", "[mm/s]"))
    assert len(rows) == 2 * len(TRIALS)
    compared = json.loads((project / "data/compare/compare.json").read_text())
    rmse = compared["trials"][0]["motors"]["left"]["current"]["rmse"]
    assert f"{1e3 * rmse:.4g}" in rows[0].split()


def test_compare_without_results_names_the_file(project, tmp_path, capsys):
    bare = tmp_path / "bare"
    shutil.copytree(project, bare)
    shutil.rmtree(bare / "data/compare")
    assert main(["compare", "--as-is", "--project", str(bare)]) == 2
    said = capsys.readouterr().err
    assert "compare.json is missing" in said
    assert said.count("\n") == 1


def test_report_writes_the_page_and_opens_it(project, capsys, monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda url: opened.append(url) or True)
    assert main(["report", "--open", "--project", str(project)]) == 0
    page = project / "reports/index.html"
    assert page.read_text(encoding="utf-8").rstrip().endswith("</html>")
    assert opened == [page.resolve().as_uri()]
    assert str(page) in capsys.readouterr().out


def test_report_without_a_browser_says_where_the_page_is(project, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(webbrowser, "open", lambda url: False)
    out = tmp_path / "page.html"
    assert main(["report", "--open", "--out", str(out), "--project", str(project)]) == 2
    assert out.exists()
    assert str(out) in capsys.readouterr().err


def test_benchmark_prints_and_writes_its_figures(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(benchmark, "MEASURES", {"rate": lambda size: {"rate.ratio": 1.5}})
    out = tmp_path / "figures.json"
    assert main(["benchmark", "--tiny", "--json", str(out)]) == 0
    assert json.loads(out.read_text()) == {"rate.ratio": 1.5}
    shown = capsys.readouterr()
    assert "rate.ratio" in shown.out
    assert "rate: " in shown.err


def test_a_measure_that_is_none_is_said(capsys):
    assert main(["benchmark", "--only", "luck"]) == 2
    assert "no measure 'luck'" in capsys.readouterr().err
