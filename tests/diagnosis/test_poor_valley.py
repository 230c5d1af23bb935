"""A search that begins in a poor valley ranks its candidates once more from a better one."""

from dataclasses import replace

from spirob.diagnosis.ladder import climb
from spirob.diagnosis.rungs import ROLES, Ladder, Settings, rung_of

from spirob.effects import find_effects
from spirob.identify.fit import fit
from tests.identify.known import residual, spirob

NAMES = ["winch.efficiency", "arm.base_stiffness"]
FRICTION, OFFSET = find_effects(["capstan_friction", "current_offset"])
TRUE = {"capstan_friction.friction": 0.04}
SETTINGS = Settings(intervals=False, always=False, rounds=1)


def test_what_was_ranked_in_a_poor_valley_is_ranked_again():
    plant = spirob([FRICTION, OFFSET])
    residuals = {role: residual(plant, TRUE, role) for role in ROLES}
    found = fit(residuals["train"], NAMES, {}, 0.05, 3, exact=False)
    far = found.changes | {"arm.base_stiffness": 4.0 * found.changes["arm.base_stiffness"]}
    poor = replace(found, changes=far, residual=residuals["train"](far), cost=100.0 * found.cost)
    base = rung_of("fitted parameters", [], poor, residuals)
    told: list[str] = []
    search = climb(
        residuals, NAMES, [FRICTION, OFFSET], {}, SETTINGS, told.append, Ladder(base, [base])
    )
    again = [k for k, line in enumerate(told) if "fitted again" in line]
    screened = [k for k, line in enumerate(told) if "screened" in line]
    assert len(again) == 1
    assert len(screened) == 2
    assert screened[0] < again[0] < screened[1]
    assert search.rungs[-1].effects == [FRICTION]
    assert search.rungs[0].scores["validate"].rmse < 0.5 * base.scores["validate"].rmse
