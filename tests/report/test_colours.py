"""The page's colours can be read, and told apart by every kind of colour vision, day and night."""

import re
from importlib import resources
from itertools import combinations

import numpy as np
import pytest

STYLE = resources.files("spirob.report").joinpath("assets/style.css").read_text(encoding="utf-8")
BLOCKS = re.findall(r":root[^{]*\{([^}]*--paper[^}]*)\}", STYLE)
THEMES = {
    name: dict(re.findall(r"--([\w-]+):\s*(#[0-9a-f]+)", block))
    for name, block in zip(("light", "dark"), BLOCKS, strict=True)
}
# Viénot, Brettel, Mollon 1999, on linear RGB
VISION = {
    "normal": np.eye(3),
    "protanopia": [[0.11238, 0.88762, 0], [0.11238, 0.88762, 0], [0.00401, -0.00401, 1]],
    "deuteranopia": [[0.29275, 0.70725, 0], [0.29275, 0.70725, 0], [-0.02234, 0.02234, 1]],
}
LINES = ("measured", "base", "named")  # what is drawn over each other
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def linear(colour):
    """Linear RGB of #rgb or #rrggbb."""
    digits = colour[1:] if len(colour) == 7 else "".join(2 * d for d in colour[1:])
    values = np.array([int(digits[k : k + 2], 16) for k in (0, 2, 4)]) / 255
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def contrast(first, second):
    """Of WCAG: 1 for equal, 21 for black on white."""
    light, dark = sorted((XYZ[1] @ linear(first), XYZ[1] @ linear(second)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def lab(rgb):
    """CIELAB of linear RGB."""
    ratio = XYZ @ np.clip(rgb, 0, 1) / (XYZ @ np.ones(3))
    f = np.where(ratio > 0.008856, np.cbrt(ratio), 7.787 * ratio + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize(
    ("colour", "least"),
    [("ink", 7), ("muted", 4.5), ("alarm", 4.5), ("named", 4.5), ("base", 3), ("measured", 3)],
)
def test_it_can_be_read_on_the_paper(theme, colour, least):
    assert contrast(THEMES[theme][colour], THEMES[theme]["paper"]) >= least


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("vision", VISION)
@pytest.mark.parametrize(("first", "second"), list(combinations(LINES, 2)))
def test_lines_are_told_apart(theme, vision, first, second):
    see = np.array(VISION[vision])
    colours = [lab(see @ linear(THEMES[theme][name])) for name in (first, second)]
    assert np.linalg.norm(colours[0] - colours[1]) > 25  # one is just noticeable
