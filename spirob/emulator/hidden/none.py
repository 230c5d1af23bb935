"""No hidden effect: what is left are the drawn parameters, noise and a trace of rotor friction."""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Nothing changes, whatever the strength."""
    return {}
