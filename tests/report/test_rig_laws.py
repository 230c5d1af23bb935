"""The laws of a rig's page: in the rig's own units, for what is named only."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from spirob.report.sections.laws import RigLaws, against_itself, law_of, over_signal

SPEED = np.linspace(-0.1, 0.1, 400)
DIAGNOSIS = {"effort": "motor force", "unit": "N", "effects": []}


def rows(name="coulomb_friction", axis="m"):
    law = 20.0 * np.sign(SPEED)
    signals = {"time": np.arange(400) * 0.01, "position": SPEED**2, "velocity": SPEED}
    plain = {"effect": name, "axis": axis, **signals, "effort": 3.0 * law}
    return pd.DataFrame({**plain, "shown": law + 1.0, "law": law})


def titles(figure):
    return figure.layout.xaxis.title.text, figure.layout.yaxis.title.text


@pytest.mark.parametrize(
    ("effect", "axis", "title"),
    [
        ("coulomb_friction", "m", "speed [mm/s]"),
        ("coulomb_friction", "rad", "speed [rad/s]"),
        ("cogging", "rad", "position [rad]"),
        ("torque_constant_saturation", "m", "motor force [N]"),
        ("constant_force", "m", "time since the log began [s]"),
    ],
)
def test_axes_carry_the_units_of_the_rig(effect, axis, title):
    found = law_of(rows(effect, axis), DIAGNOSIS)
    assert titles(over_signal(found)) == (title, "motor force [N]")
    assert titles(against_itself(found)) == ("fitted law [N]", "residual without it [N]")


def test_a_force_is_drawn_in_newton_and_not_in_thousandths():
    figure = over_signal(law_of(rows(), DIAGNOSIS))
    assert max(figure.data[1].y) == pytest.approx(20.0)
    assert max(figure.data[1].x) == pytest.approx(100.0)  # mm/s


def context(named, laws):
    effects = [{"name": name, "title": name} for name in named]
    data = SimpleNamespace(diagnosis={**DIAGNOSIS, "effects": effects}, laws=laws)
    return RigLaws().get_context(data)


def test_two_plots_and_a_sentence_for_each_named_effect_and_no_other():
    both = pd.concat([rows(), rows("cogging")], ignore_index=True)
    (shown,) = context(["coulomb_friction"], both)["effects"]
    names = [plot.name for plot in shown["plots"]]
    assert names == ["law-coulomb_friction", "law-coulomb_friction-itself"]
    assert "accounts for" in shown["sentence"]


def test_without_a_name_or_laws_there_is_a_sentence():
    assert context([], rows())["effects"] == []
    absent = context(["coulomb_friction"], None)
    assert absent["effects"] == []
    assert absent["reason"].endswith(".")
