"""The documents are true: blocks run, links lead somewhere, tables are today's."""

import re
from pathlib import Path

import pytest

from spirob.cli.reference import features
from spirob.cli.reference.ports import renewed
from spirob.perceive.features import FEATURES
from tests.docs.blocks import follow

DOCS = Path(__file__).parents[2] / "docs"
OWN = ("from_python", "tutorial", "new_effect", "conventions", "reference")


@pytest.mark.parametrize(
    ("page", "blocks"), [("tutorial", 7), ("new_effect", 2), ("from_python", 1)]
)
def test_every_block_does_what_the_page_says(page, blocks, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert follow(DOCS / f"{page}.md", capsys) == blocks


def test_a_block_that_says_something_else_is_found(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "page.md").write_text("```console\n$ spirob --version\nversion of the moon\n```\n")
    with pytest.raises(AssertionError, match="version of the moon"):
        follow(tmp_path / "page.md", capsys)


def test_the_ports_of_the_conventions_are_those_of_the_program():
    text = (DOCS / "conventions.md").read_text(encoding="utf-8")
    assert renewed(text) == text
    assert renewed(text.replace("N·m", "Nm")) != text.replace("N·m", "Nm")


def test_the_features_of_the_experiments_are_those_of_the_program():
    text = (DOCS / "experiments.md").read_text(encoding="utf-8")
    assert features.renewed(text) == text
    for name, one in FEATURES.items():
        assert text.count(f"| {one.kind} | `{name}` | {one.unit} | ") == 1
    gone = text.replace("`stall_time`", "`stalled`")
    assert features.renewed(gone) != gone


@pytest.mark.parametrize("page", OWN)
def test_links_lead_to_files(page):
    text = (DOCS / f"{page}.md").read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)#]+)\)", text)
    assert links
    assert [link for link in links if not (DOCS / link).exists()] == []
