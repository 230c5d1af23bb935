"""A law alone outdoes names where it is plainer than they and halves what they leave."""

from types import SimpleNamespace

import pytest

from spirob.effects import all_effects
from spirob.identify.intervals import Estimate
from spirob.machine.judging import may_outdo, numbers, outdone


def model(*names, told=(), left=1.0):
    """A fitted model in which these numbers alone are told beside nothing."""
    effects = tuple(all_effects()[name] for name in names)
    estimates = {}
    for effect in effects:
        for field, about in effect.parameters().items():
            full, zero = f"{effect.name()}.{field}", effect.neutral.get(field, about.nominal)
            low, high = (1.0, 2.0) if full in told else (zero - 1.0, zero + 1.0)
            estimates[full] = Estimate(0.5 * (low + high), low, high, about.unit, False)
    return SimpleNamespace(
        effects=effects, fit=SimpleNamespace(estimates=estimates), mean_square=left
    )


ONE_WAVE = model("cogging", told=("cogging.sine", "cogging.cosine"))
THREE_WAVES = model(
    "cogging",
    told=[f"cogging.{n}{w}" for n in ("", "second_", "third_") for w in ("sine", "cosine")],
)


def test_numbers_are_those_that_are_told_and_their_shapes():
    assert numbers(ONE_WAVE) == 3  # two amplitudes and the order
    assert numbers(THREE_WAVES) == 9
    assert numbers(model("cogging")) == 0
    assert numbers(model("quadratic_drag", told=("quadratic_drag.drag",))) == 1
    bristle = all_effects()["presliding_friction"]
    assert bristle.state
    told = [f"presliding_friction.{f}" for f in bristle.neutral]
    assert numbers(model("presliding_friction", told=told)) == len(bristle.parameters()) + 1


class Stub:
    """Answers the questions of the criteria by the errors."""

    def halves(self, before, after):
        return after.mean_square < 0.5 * before.mean_square

    def clearly(self, before, after):
        return after.mean_square < 0.9 * before.mean_square


@pytest.mark.parametrize(
    ("alone", "left", "beside_left", "out"),
    [
        (ONE_WAVE, 0.1, 0.1, True),
        (ONE_WAVE, 0.1, None, True),  # nothing is composed beside the names
        (ONE_WAVE, 0.6, 0.6, False),  # it leaves too much
        (ONE_WAVE, 0.1, 0.05, False),  # the names with their law leave less
        (THREE_WAVES, 0.1, 0.1, False),  # it is no plainer
    ],
)
def test_a_plainer_law_that_halves_what_is_left_outdoes_names(alone, left, beside_left, out):
    law = SimpleNamespace(model=SimpleNamespace(**{**vars(alone), "mean_square": left}))
    beside = None
    if beside_left is not None:
        beside = SimpleNamespace(
            model=SimpleNamespace(**{**vars(THREE_WAVES), "mean_square": beside_left})
        )
    assert outdone(Stub(), THREE_WAVES, beside, law) is out
    assert not outdone(Stub(), THREE_WAVES, beside, None)


@pytest.mark.parametrize(
    ("richness", "left", "may"), [(3, 0.9, True), (9, 0.1, False), (3, 1.1, False)]
)
def test_a_draft_that_cannot_is_not_fitted(richness, left, may):
    draft = SimpleNamespace(richness=richness, mean_square=left)
    assert may_outdo(THREE_WAVES, None, draft) is may
