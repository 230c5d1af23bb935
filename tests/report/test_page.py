"""The finished page: alone on the machine, small enough, the same again for the same data."""

import re

from spirob.report import build, json_script, plotly_script, render

LARGEST = 8_000_000  # bytes


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
    assert "RMSE of current [A]" in page
    assert all(unit in page for unit in ("share [%]", "time [s]", "diameter [mm]"))


def test_every_link_inside_the_page_leads_somewhere(page):
    links = set(re.findall(r'href="#([^"]+)"', page))
    assert len(links) > 10
    assert links <= set(re.findall(r'id="([^"]+)"', page))


def test_every_id_is_given_once(page):
    ids = re.findall(r'<[a-z]+[^>]*\sid="([^"]+)"', page.replace(plotly_script(), ""))
    assert len(ids) == len(set(ids))


def test_data_cannot_end_their_script():
    assert "</script>" not in json_script("x", {"a": "</script><!--"}).removesuffix("</script>")
