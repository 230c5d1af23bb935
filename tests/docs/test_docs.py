"""The documents are true: blocks run, links lead somewhere, tables are today's."""

import re
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from jinja2 import Environment, StrictUndefined

from spirob.cli.doc_tables import SCHEMA, renewed, schema
from spirob.diagnosis.schema import Document
from spirob.machine.arm.description import ArmFile
from spirob.machine.description.rig import RigFile
from spirob.perceive.features import FEATURES
from tests.docs.blocks import BLOCK, follow

DOCS = Path(__file__).parents[2] / "docs"
ROOT = DOCS.parent
STATED = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]
PAGES = [*STATED, *sorted((DOCS / "lab").glob("*.md")), ROOT / "CHANGELOG.md"]
NAMED = re.compile(r"`((?:spirob|pipeline|tests|conf|docs)/[\w./]+)`")  # of files and folders
SHORT = {"diagnosis": 1200, "any_rig": 1200}  # words


@pytest.mark.parametrize(
    ("page", "blocks"), [("tutorial", 16), ("new_effect", 2), ("from_python", 1)]
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
    assert renewed("conventions.md", text) == text
    gone = text.replace("N·m", "Nm")
    assert renewed("conventions.md", gone) != gone


def test_the_features_of_a_wrap_are_those_of_the_program():
    text = (DOCS / "size.md").read_text(encoding="utf-8")
    assert renewed("size.md", text) == text
    for name, one in FEATURES.items():
        assert text.count(f"| {one.kind} | `{name}` | {one.unit} | ") == 1
    gone = text.replace("`stall_time`", "`stalled`")
    assert renewed("size.md", gone) != gone


def test_the_keys_and_the_schema_of_a_diagnosis_are_those_of_the_program():
    text = (DOCS / "result.md").read_text(encoding="utf-8")
    assert renewed("result.md", text) == text
    assert (DOCS / SCHEMA).read_text(encoding="utf-8") == schema()
    for name, field in Document.model_fields.items():
        assert f"| `{name}` | " in text
        assert str(field.description) in text


def test_descriptions_on_the_pages_of_a_rig_are_descriptions():
    texts = [(DOCS / f"{page}.md").read_text(encoding="utf-8") for page in ("any_rig", "rig_keys")]
    blocks = [
        yaml.safe_load(b) for b in re.findall(r"```yaml\n(.*?)```", "".join(texts), re.DOTALL)
    ]
    rigs = [b for b in blocks if "name" in b]
    assert len(rigs) == len(blocks) == 4
    for rig in rigs:
        kind = ArmFile if rig.get("body") == "arm" else RigFile
        assert kind.model_validate(rig).name == rig["name"]


def anchors(page):
    """Of its headings, as GitHub makes them."""
    heads = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head).strip().lower().replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_files_and_headings(page):
    links = re.findall(r"\]\(([^)]+)\)", page.read_text(encoding="utf-8"))
    assert links
    for link in links:
        file, _, heading = link.partition("#")
        if file.startswith("http"):
            continue
        target = (page.parent / file) if file else page
        assert target.exists(), link
        assert not heading or heading in anchors(target), link


@pytest.mark.parametrize("page", STATED, ids=lambda page: page.name)
def test_files_that_a_page_names_exist(page):
    named = set(NAMED.findall(page.read_text(encoding="utf-8")))
    made_up = {name for name in named if "NAME" in name or name.startswith("data/")}
    assert [name for name in sorted(named - made_up) if not (ROOT / name).exists()] == []


def torn(text):
    """First lines of what a blank line cuts off from its table or list, and where two are one."""
    prose = re.sub(r"^```.*?^```$", "code", text, flags=re.MULTILINE | re.DOTALL)
    rows = re.findall(r"(?<=\n\n)\|.*(?=\n(?!\|---))", prose)
    items = re.findall(r"^- .*\n(?:  .*\n)*\n+(- .*)$", prose, re.MULTILINE)
    return rows + items + re.findall(r"\n{3,}(.*)", prose)


def test_what_is_torn_is_found():
    whole = "a\n\n| a | b |\n|---|---|\n| 1 | 2 |\n\n- one\n  more\n- two\n\n```py\na\n\n\nb\n```\n"
    assert torn(whole) == []
    assert torn(whole + "\n| 3 | 4 |\n") == ["| 3 | 4 |"]
    assert torn(whole.replace("- two", "\n- two")) == ["- two"]
    assert torn(whole + "\n\nb\n") == ["b"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_no_table_or_list_of_a_page_is_torn(page):
    assert torn(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("page", SHORT)
def test_a_page_that_is_read_whole_is_short(page):
    assert len((DOCS / f"{page}.md").read_text(encoding="utf-8").split()) <= SHORT[page]


def test_every_page_is_found_from_the_first():
    first = (DOCS / "README.md").read_text(encoding="utf-8")
    pages = [*DOCS.glob("*.md"), *DOCS.glob("lab/*.md")]
    lab = (DOCS / "lab" / "README.md").read_text(encoding="utf-8")
    found = re.findall(r"\]\((?:lab/)?([^)#]+)\)", first + lab)
    assert {page.name for page in pages} - {"README.md"} <= set(found)


def test_the_section_of_the_page_renders(tmp_path):
    blocks = BLOCK.findall((DOCS / "extending.md").read_text(encoding="utf-8"))
    (_, script, code), (_, file, template) = blocks
    names = {"__name__": "spirob.report.sections." + script.removesuffix(".py")}
    exec(compile(code, script, "exec"), names)
    section = names["TrialList"]()
    assert (section.name, section.template) == ("trial_list", file)
    data = SimpleNamespace(compare={"trials": [{"name": "deep bend"}]})
    page = Environment(undefined=StrictUndefined).from_string(template)
    assert "<li>deep bend</li>" in page.render(section.get_context(data))
