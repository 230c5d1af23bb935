"""The laws that an effect is held to, one line each: kept, broken and how, or why not asked."""

import inspect
from collections.abc import Iterator
from pathlib import Path

from spirob.effects import Effect
from spirob.effects.check import LAWS, Finding, check
from spirob.errors import ExportError
from spirob.export.corrected import Held
from spirob.export.law import kernel_functions, law_of
from spirob.plant import check as model
from spirob.ports import PORTS

MODEL_LAWS = {law.__name__: law for law in (model.compiled, *model.LAWS)}


def battery(effect: type[Effect], alone: bool) -> tuple[list[str], bool]:
    """Lines that tell of every law, and whether the effect keeps all that were asked.

    alone  leave out the laws of the arm's model
    """
    refused = {"exported": said} if (said := exported(effect)) else {}
    broken = _by_law(check(effect))
    lines = [_line(law, test, broken, _absent(law, effect)) for law, test in LAWS.items()]
    lines.append(_line("exported", exported, refused, ""))
    why = "not asked (--alone)" if alone else "not asked: the kernel breaks a law of its own"
    if not (alone or broken):
        broken = _by_law(model.check_in_model(effect))
        why = ""
    return [*lines, *_of_the_model(effect, broken, why)], not (broken or refused)


def exported(effect: type[Effect]) -> str:
    """Its kernel can be written as C for `spirob export`."""
    try:
        text = Path(inspect.getfile(effect.kernel)).read_text(encoding="utf-8")
        kernel_functions(Held(law_of(effect.name(), text, effect), {}))
    except ExportError as refused:
        return str(refused)
    return ""


def _by_law(findings: list[Finding]) -> dict[str, str]:
    laws = dict.fromkeys(finding.law for finding in findings)
    return {law: "; ".join(f.sentence for f in findings if f.law == law) for law in laws}


def _of_the_model(effect: type[Effect], broken: dict[str, str], why: str) -> Iterator[str]:
    for law, test in MODEL_LAWS.items():
        yield _line(law, test, broken, why or _absent(law, effect))
        if law in broken and not why:
            why = f"not asked, as it breaks '{law}'"


def _line(law: str, test: object, broken: dict[str, str], why: str) -> str:
    if why:
        return f"{law}: {why}"
    if law in broken:
        return f"{law}: broken: {broken[law]}"
    return f"{law}: kept: {(test.__doc__ or '').strip().splitlines()[0]}"


def _absent(law: str, effect: type[Effect]) -> str:
    """Why this effect has nothing that the law could hold it to; empty where it has."""
    if law == "equation" and not effect.equation and effect.state:
        return "does not apply: it states no equation"
    if law in ("evolution", "bounded") and not effect.state:
        return "does not apply: it remembers nothing"
    if law == "evolution" and not effect.evolution:
        return "does not apply: it states no law of its memory"
    if law == "traits" and not effect.traits:
        return "does not apply: it claims none"
    if law == "compiled" and PORTS[effect.port].every == "once":
        return "does not apply: it acts once, before the model runs"
    return ""
