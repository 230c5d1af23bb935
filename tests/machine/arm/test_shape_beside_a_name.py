"""A shape that was found without the named effect is taken again beside it, if the names stay."""

from types import SimpleNamespace

import pytest

from spirob.diagnosis.criteria import Settings
from spirob.machine.arm import diagnosis
from spirob.machine.arm.diagnosis import Asked


def searched(*names):
    model = SimpleNamespace(effects=(), fit=f"fit with {names}")
    return SimpleNamespace(
        verdict=SimpleNamespace(named=list(names)),
        ended=SimpleNamespace(found=SimpleNamespace(chosen=model)),
    )


@pytest.mark.parametrize(
    ("again", "stands"), [(["drag", "friction"], True), (["friction"], False), ([], False)]
)
def test_it_stands_where_the_same_is_named(monkeypatch, again, stands):
    before, after = searched("friction", "drag"), searched(*again)
    ground, other = SimpleNamespace(numbers={"a": 1.0}), SimpleNamespace(numbers={})
    asked_of = []

    def settled_with(residuals, fit, free, settings, progress):
        asked_of.append(fit)
        return other

    monkeypatch.setattr(diagnosis, "settled_with", settled_with)
    monkeypatch.setattr(Asked, "searched", lambda self, ground, bare, effects: after)
    told = []
    asked = Asked({}, [], [], ["holes.shift"], Settings(), told.append)
    assert asked.with_named(ground, before) == ((other, after) if stands else (ground, before))
    assert asked_of == [before.ended.found.chosen.fit]
    assert told == ["the arm's shape once more, with the fitted numbers alone"]
