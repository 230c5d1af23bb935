"""Data inside the page: JSON that no HTML parser can mistake for the end of its script."""

import json
from typing import Any

from markupsafe import Markup


def json_script(name: str, value: Any) -> Markup:
    """`value` as a script element of type JSON with the id `name`."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    text = text.replace("</", "<\\/").replace("<!--", "<\\u0021--")
    return Markup(f'<script type="application/json" id="{name}">{text}</script>')
