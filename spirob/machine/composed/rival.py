"""Whether a law that was composed without any name does better than the names that were found.

A name stands for a cause, a law for a shape; where both tell the same, the name is preferred.  But
where something is left beside the names that follows from the motion, a law of what they are meant
to explain, composed beside the fitted numbers alone, may be plainer than the names and what is
composed beside them, and predict as well.  The names then only imitate it.
"""

from spirob.diagnosis.criteria import Worth
from spirob.diagnosis.model import Model
from spirob.machine.composed.composing import Composed
from spirob.machine.composed.draft import Draft
from spirob.machine.shapes import shaping

TERM = 2  # numbers, an amplitude and what shapes it: a law is plainer by a term at least
OUTDONE = (
    "A law composed without any name is plainer and leaves less than half the squared error: what "
    "was nearest only imitates it."
)


def outdone(worth: Worth, named: Model, beside: Composed | None, alone: Composed | None) -> bool:
    """Whether the law `alone` halves what `named` leaves, and is plainer than it and its law.

    named   the model with the names;  beside  the law of what it leaves
    alone   the law of what the fitted numbers leave

    With the names and the law beside them clearly better, they are not outdone.
    """
    richer = beside.model if beside else named
    return (
        alone is not None
        and worth.halves(named, alone.model)
        and numbers(alone.model) + TERM <= numbers(richer)
        and not worth.clearly(alone.model, richer)
    )


def may_outdo(named: Model, beside: Composed | None, draft: Draft) -> bool:
    """Whether a draft is plain enough and leaves little enough to be such a law."""
    plainer = draft.richness + TERM <= numbers(beside.model if beside else named)
    return plainer and draft.mean_square < named.mean_square


def numbers(model: Model) -> int:
    """Numbers of its effects that a model tells, and one more for each that remembers.

    Told is an amplitude whose interval holds no neutral value, and what shapes such a one.
    """
    count = 0
    for effect in model.effects:
        names = {f: f"{effect.name()}.{f}" for f in effect.fitted()}
        found = {f: model.fit.estimates[n] for f, n in names.items() if n in model.fit.estimates}
        told = [
            f
            for f, zero in effect.neutral.items()
            if f in found and not found[f].low <= zero <= found[f].high
        ]
        shapes = {shape for field in told for shape in shaping(effect, field)}  # type: ignore[arg-type] # a class is hashable
        count += len(told) + len(shapes & set(found)) + bool(effect.state)
    return count
