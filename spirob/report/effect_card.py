"""What the page tells about an effect: from its declaration, for whoever has never met it."""

from typing import Any

from markupsafe import Markup

from spirob.effects.effect import Effect
from spirob.ports import PORTS, SIGNALS
from spirob.report.numbers import given, unit_text
from spirob.report.typeset import equation, rate, symbol, word


def card(effect: type[Effect]) -> dict[str, Any]:
    """Everything that the template prints of one effect."""
    port = PORTS[effect.port]
    return {
        "name": effect.name(),
        "title": effect.title,
        "place": effect.__module__.split(".")[-2],
        "port": effect.port,
        "does": f"{'is a part of' if port.combine == 'sum' else 'changes'} the {port.meaning}",
        "explanation": effect.explanation,
        "signature": effect.signature,
        "equations": equations(effect),
        "reads": [SIGNALS[signal].meaning for signal in effect.reads.values()],
        "numbers": [
            {
                "name": name,
                "symbol": Markup(f"<math>{symbol(about.symbol)}</math>"),
                "meaning": about.meaning,
                "nominal": given(about.nominal),
                "bounds": f"{given(about.low)} to {given(about.high)}",
                "unit": unit_text(about.unit),
                "absent_at": given(effect.neutral[name]) if name in effect.neutral else "",
            }
            for name, about in effect.parameters().items()
        ],
        "needs": effect.needs,
        "tell_apart": {rival.replace("_", " "): test for rival, test in effect.tell_apart.items()},
        "references": effect.references,
    }


def equations(effect: type[Effect]) -> list[Markup]:
    """The law and, where it has a memory, how that changes; empty where it is no formula."""
    symbols = [about.symbol for about in effect.parameters().values()]
    found = []
    if effect.equation:
        left = word(effect.port.rpartition(".")[2])
        found.append(equation(left, effect.equation, symbols))
    for state, law in effect.evolution.items():
        found.append(equation(rate(state), law, symbols))
    return found
