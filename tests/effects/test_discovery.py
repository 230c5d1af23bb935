"""The pages of effects, the catalogue and the how-to, say what the code says."""

import re
from pathlib import Path

from spirob.cli.doc_tables import renewed
from spirob.effects import all_effects
from spirob.effects.check import LAWS

DOCS = Path(__file__).parents[2] / "docs"


def test_the_page_holds_the_table_of_the_library():
    page = (DOCS / "effects.md").read_text(encoding="utf-8")
    assert renewed("effects.md", page) == page
    assert all(f"`{name}`" in page for name in all_effects())


def test_the_how_to_names_every_law():
    page = (DOCS / "new_effect.md").read_text(encoding="utf-8")
    named = set(re.findall(r"^\| ([a-z]+) \|", page, re.MULTILINE))
    assert named >= {*LAWS, "exported", "compiled", "nested", "seen", "found"}
