"""Machines to put to the test, and an arm written out by hand to compare them with."""

from collections.abc import Callable

import numpy as np
import pytest

from spirob.emulator.machine import Machine
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.robot import Scene

SLACK = -1.0  # m of tendon paid out


@pytest.fixture
def machine() -> Callable[..., Machine]:
    """Build a machine without friction, noise or hidden effect, unless told otherwise."""

    def build(
        effect: str = "none",
        strength: float = 1.0,
        seed: int = 3,
        clean: bool = True,
        build: str = "as_designed",
        **rig,
    ) -> Machine:
        made = Machine(EmulatedRig(**rig), HiddenSettings(effect, strength, build), seed)
        if clean:
            made.numbers["current_noise"] = 0.0
            if effect != "rotor_friction":
                made.numbers["coulomb"] = 0.0
                made.numbers["breakaway"] = 0.0
        made.start(Scene(), "test")
        return made

    return build


def play(machine: Machine, currents: tuple[float, float], cycles: int) -> None:
    """Hold two currents for some cycles."""
    for _ in range(cycles):
        machine.cycle(currents)


def loosen(machine: Machine, sides: tuple[int, ...] = (0, 1)) -> None:
    """Pay out so much tendon that it cannot pull."""
    for m in sides:
        machine.state["wound"][0, m] = SLACK


def calm(machine: Machine) -> Machine:
    """A light rotor with so much drag that arm and winch do not swing about their rest."""
    machine.numbers["rotor_inertia"] = 5e-6
    machine.numbers["rotor_damping"] = 1.2e-5 if machine.rig.gear_ratio > 2 else 1e-3
    return machine


def hinge_angles(machine: Machine) -> np.ndarray:
    """q of every hinge [rad]."""
    return np.diff(np.concatenate([[0.0], machine.state["phi"][0]]))


def mirrored(machine: Machine) -> Machine:
    """Give both sides of the machine the numbers of its left side."""
    for name in machine.numbers.dtype.names:
        field = machine.numbers[name]
        if field.ndim >= 2 and field.shape[1] == 2 and name not in ("gravity",):
            field[0, 1] = field[0, 0]
    return machine
