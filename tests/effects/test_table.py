"""The page for those who write effects says what the code says."""

import re
from pathlib import Path

from spirob.effects import all_effects
from spirob.effects.check import LAWS
from spirob.effects.table import table

PAGE = Path(__file__).parents[2] / "docs" / "effects.md"


def test_the_page_holds_the_table_of_the_library():
    page = PAGE.read_text()
    # refresh with: python -c "from spirob.effects.table import table; print(table())"
    assert page.endswith(table())
    assert all(f"`{name}`" in page for name in all_effects())


def test_the_page_names_every_law():
    named = set(re.findall(r"^\| ([a-z]+) \|", PAGE.read_text(), re.MULTILINE))
    assert named >= {*LAWS, "compiled", "nested", "seen", "found"}
