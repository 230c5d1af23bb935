"""The library as a table, made from the declarations."""

from spirob.effects.discovery import all_effects
from spirob.effects.effect import Effect

HEAD = ("| effect | acts on | numbers | shows as | needs |", "|---|---|---|---|---|")


def table() -> str:
    """All effects by place, as Markdown; at zero of its numbers in bold an effect is absent."""
    found = all_effects().values()
    places = sorted({_place(effect) for effect in found})
    parts = []
    for place in places:
        rows = [_row(effect) for effect in found if _place(effect) == place]
        parts.append("\n".join([f"### {place}", "", *HEAD, *rows]))
    return "\n\n".join(parts) + "\n"


def _place(effect: type[Effect]) -> str:
    return effect.__module__.split(".")[-2]


def _row(effect: type[Effect]) -> str:
    numbers = []
    for name, about in effect.parameters().items():
        shown = f"**{about.symbol}**" if name in effect.neutral else about.symbol
        unit = "" if about.unit == "1" else f" {about.unit}"
        numbers.append(f"{shown} {about.nominal:g}{unit} ({about.meaning})")
    who = f"`{effect.name()}`<br>{effect.title}"
    cells = (who, f"`{effect.port}`", "<br>".join(numbers), effect.signature, effect.needs)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
