"""Electrical in = heat + kinetic + elastic + gravity + gear loss booked with its sign, within 1 %.

Stage by stage as well, each against what that stage itself turns over: heat in the winding would
hide any error behind the rotor.  The arm hangs (gravity along the straight arm, so that it starts
at rest), is bent and let go again; no hinge reaches its stop, whose loss is not booked.
"""

import dataclasses
from functools import cache

import numpy as np
import pytest

from spirob.plant.rig import Arm
from tests.physics.energy import account
from tests.physics.playing import RIGS, currents, rising, seconds

T = seconds(2.0)
PULL = {"geared": (1.0, 0.3), "direct": (0.5, 0.1)}


@cache
def booked(ratio):
    rig = dataclasses.replace(RIGS[ratio], arm=Arm(gravity_x=9.81))
    left, right = PULL[ratio]
    up_and_down = rising(T, 0.8) - 0.9 * rising(T - 1.0, 0.4)
    return account(rig, currents(left * up_and_down, right * rising(T, 0.4)))


def lost(a):
    return a.winding_heat + a.gear_loss + a.rotor_heat + a.tendon_heat + a.arm_heat


def stored(a):
    tendon_and_arm = a.tendon_elastic + a.arm_kinetic + a.arm_potential
    return a.magnetic + a.rotor_kinetic + tendon_and_arm


@pytest.mark.parametrize("ratio", RIGS)
def test_the_whole_chain_keeps_its_energy(ratio):
    a = booked(ratio)
    assert lost(a) + stored(a) == pytest.approx(a.electrical, rel=0.01)


@pytest.mark.parametrize("ratio", RIGS)
def test_the_winding_turns_the_rest_into_work_at_the_shaft(ratio):
    a = booked(ratio)
    assert a.winding_heat + a.magnetic + a.shaft == pytest.approx(a.electrical, rel=0.002)


@pytest.mark.parametrize("ratio", RIGS)
def test_rotor_and_gear_keep_their_energy(ratio):
    a = booked(ratio)
    turned_over = a.rotor_heat + abs(a.gear_loss) + abs(a.drum) + a.rotor_kinetic
    left_over = a.shaft - a.gear_loss - a.rotor_heat - a.rotor_kinetic - a.drum
    assert abs(left_over) < 0.01 * turned_over


@pytest.mark.parametrize("ratio", RIGS)
def test_the_tendon_keeps_its_energy(ratio):
    a = booked(ratio)
    left_over = a.drum - a.tendon_heat - a.tendon_elastic - a.arm_work
    assert abs(left_over) < 0.01 * (abs(a.drum) + a.tendon_heat + a.tendon_elastic)


@pytest.mark.parametrize("ratio", RIGS)
def test_the_arm_keeps_its_energy(ratio):
    a = booked(ratio)
    left_over = a.arm_work - a.arm_heat - a.arm_kinetic - a.arm_potential
    assert abs(left_over) < 0.01 * (a.arm_heat + a.arm_kinetic + a.arm_potential)


def test_a_gear_driven_by_its_load_makes_energy_with_a_constant_efficiency():
    # the account closes only with the sign: (1-η)τω is negative where the load drives the motor
    a = booked("direct")
    assert a.forward_shaft > 0.0
    assert a.backward_shaft < 0.0
    efficiency = RIGS["direct"].winch.efficiency
    assert a.gear_loss == pytest.approx(
        (1.0 - efficiency) * (a.forward_shaft + a.backward_shaft), rel=1e-9
    )
    unsigned = (1.0 - efficiency) * (a.forward_shaft - a.backward_shaft)
    turned_over = a.rotor_heat + abs(a.drum) + a.rotor_kinetic
    left_over = a.shaft - unsigned - a.rotor_heat - a.rotor_kinetic - a.drum
    assert abs(left_over) > 0.02 * turned_over


def test_every_loss_takes_energy_out():
    for ratio in RIGS:
        a = booked(ratio)
        assert min(a.winding_heat, a.rotor_heat, a.tendon_heat, a.arm_heat) > 0.0
        assert np.isfinite(a.electrical)
