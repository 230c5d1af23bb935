"""Dry friction of an axis, beside LuGre's equations solved by another's integrator."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

from spirob.effects import all_effects
from spirob.effects.replay import run
from spirob.machine.laws import FRICTION
from spirob.machine.result import Diagnosis
from spirob.report.sections.ladder import declared
from spirob.report.sections.library import equations

DT, END = 1e-4, 2.0
REST = 1e-3  # rad/s
T = np.arange(0.0, END, DT)


def speed(t):
    """Slow and fast, there and back [rad/s]."""
    return np.sin(2 * np.pi * 1.3 * t) * (0.6 + 0.4 * np.cos(2 * np.pi * 0.4 * t))


def lugre(level, way, damping):
    """Torque of LuGre's bristles on the grid: σ₀·x + σ₁·x', x' = v - σ₀·|v|·x/g(v), x in rad."""
    stiff = level(0.0) / way

    def bend(t, x):
        v = speed(t)
        return v - stiff * abs(v) * x / level(v)

    x = solve_ivp(bend, (0.0, END), [0.0], t_eval=T, rtol=1e-9, atol=1e-12, max_step=1e-3).y[0]
    return -stiff * (x + damping * bend(T, x))


def test_damped_bristles_are_those_of_lugre():
    numbers = {"sliding_torque": 0.02, "presliding": 0.05, "damping": 0.02, "exponent": 1.0}
    torque, _ = run(FRICTION["presliding_friction"], numbers, {"speed": speed(T)}, DT)
    np.testing.assert_allclose(torque, lugre(lambda v: 0.02, 0.05, 0.02), atol=2e-5)


@pytest.mark.parametrize("exponent", [0.0, 0.4, 0.999, 1.3])
def test_bristles_bend_as_dahl_has_it(exponent):
    """dz/dt = ω/δ·(1 - z·sgn ω)^α, by another's integrator; a spring that slips in closed form."""
    numbers = {"sliding_torque": 1.0, "presliding": 0.05, "damping": 0.0, "exponent": exponent}
    torque, _ = run(FRICTION["presliding_friction"], numbers, {"speed": speed(T)}, DT)
    if exponent == 0.0:
        wound, expected = 0.0, np.empty(len(T))
        for k, step in enumerate(speed(T) * DT):
            wound = expected[k] = min(max(wound + step / 0.05, -1.0), 1.0)
    else:

        def bend(t, z):
            lacking = np.maximum(0.0, 1.0 - z * np.sign(speed(t)))
            return speed(t) / 0.05 * lacking**exponent

        told = {"t_eval": T, "rtol": 1e-8, "atol": 1e-10, "max_step": 1e-3}
        expected = solve_ivp(bend, (0.0, END), [0.0], **told).y[0]
    np.testing.assert_allclose(-torque, expected, atol=3e-3)


def test_a_peak_on_bristles_is_that_of_lugre():
    numbers = {"coulomb_torque": 0.02, "breakaway_excess": 0.015, "presliding": 0.05}
    numbers |= {"softness": 0.05, "stribeck_ratio": 50.0}
    given = {"speed": speed(T), "rest_speed": np.full(len(T), REST)}
    torque, _ = run(FRICTION["stribeck_friction"], numbers, given, DT)

    def level(v):
        return 0.02 + 0.015 * np.exp(-((v / (50 * REST)) ** 2))

    np.testing.assert_allclose(torque, lugre(level, 0.05, 0.0), atol=1e-4)


@pytest.mark.parametrize("name", list(FRICTION))
def test_without_damping_and_way_they_are_the_laws_of_the_library(name):
    own, other = FRICTION[name], all_effects()[name]
    nominal = {f: p.nominal for f, p in other.parameters().items()}
    neither = (
        {"damping": 0.0, "exponent": 1.0}
        if "damping" in own.parameters()
        else {"presliding": 1e-12}
    )
    given = {"speed": speed(T), "rest_speed": np.full(len(T), REST)}
    mine, theirs = (
        run(law, numbers, {a: given[a] for a in law.reads}, DT)[0]
        for law, numbers in ((own, nominal | neither), (other, nominal))
    )
    np.testing.assert_allclose(mine, theirs, atol=1e-12)


@pytest.mark.parametrize("name", list(FRICTION))
def test_the_page_states_the_law_that_was_fitted(name):
    law, none = FRICTION[name], pd.DataFrame()
    told = {"effects": [{"name": name, "title": law.title}]}
    told["model"] = {"effects": [{"name": name, "source": law.__module__}]}
    library = Diagnosis(told, none, {}, "", none).library
    cards = declared(SimpleNamespace(diagnosis=told, library=library))
    assert cards[name]["equations"] == equations(law) != equations(all_effects()[name])
