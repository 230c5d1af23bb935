"""The finished page: alone on the machine, small enough, the same again for the same data."""

import re
import shutil
import subprocess

import pytest

from spirob.report import build, render
from spirob.report.embed import json_script
from spirob.report.plotly_script import plotly_script

LARGEST = 8_000_000  # bytes
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-logging=stderr",
    "--virtual-time-budget=8000",
    "--window-size=1280,2400",
)


def test_the_page_holds_no_address_of_another_host(page):
    assert re.findall(r"(?:https?|wss?|ftp)://[^\s\"'<]*", page) == []
    assert re.findall(r"(?:src|href|action|poster)\s*=\s*[\"']?//", page) == []


def test_nothing_is_loaded_from_outside_the_page(page):
    markup = page.replace(plotly_script(), "")
    assert re.findall(r"<script[^>]*\ssrc=", markup) == []
    assert re.findall(r"@import|url\(", markup) == []
    assert set(re.findall(r"(?:href|src)=\"([^\"#]*)", markup)) == {"", "data:,"}
    assert "default-src 'none'" in markup


def test_xml_namespaces_survive_for_the_browser():
    assert r"http:\/\/www.w3.org/2000/svg" in plotly_script()


def test_the_page_is_small_and_holds_one_plotly(page):
    assert len(page.encode()) < LARGEST
    assert page.count(plotly_script()) == 1


def test_equal_data_give_equal_bytes(data, page):
    assert render(data) == page


def test_the_page_is_written_whole(data, tmp_path):
    out = build(data, tmp_path / "reports" / "index.html")
    assert out.read_text(encoding="utf-8").rstrip().endswith("</html>")
    assert [f.name for f in out.parent.iterdir()] == ["index.html"]


def test_every_figure_has_units_on_its_axes(page):
    assert "held-out RMSE of current [A]" in page
    assert all(unit in page for unit in ("share [%]", "time [s]", "diameter [mm]"))


def test_data_cannot_end_their_script():
    assert "</script>" not in json_script("x", {"a": "</script><!--"}).removesuffix("</script>")


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium to draw the page")
def test_a_browser_draws_every_figure_without_complaint(page, tmp_path):
    path = tmp_path / "index.html"
    path.write_text(page, encoding="utf-8")
    profile = f"--user-data-dir={tmp_path / 'profile'}"
    command = [CHROMIUM, *FLAGS, profile, "--dump-dom", path.as_uri()]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    assert [line for line in ran.stderr.splitlines() if "CONSOLE" in line] == []
    for name in ("rungs", "overlay", "atlas", "size"):
        place = ran.stdout.split(f'<div class="plot js-plotly-plot" id="{name}"')
        assert len(place) == 2, f"{name} was not drawn"
        assert "<svg" in place[1][:3000]
    assert ran.stdout.count("<option") == 12  # six trials to choose from, twice
    assert re.search(r'<input type="range" id="arm-time"[^>]*max="719"', ran.stdout)
