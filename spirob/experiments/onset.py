"""When a contact begins in a motor's current, and when a detector declares it."""

import numpy as np

from spirob.experiments.response import PERIOD, smooth
from spirob.perceive.contact import ContactDetector, ContactSettings

DEPARTS = 0.025  # A: five times the sensor's noise
PARTED = 50  # samples


def onset(contact: np.ndarray, free: np.ndarray, first: int) -> float:
    """Time [s] at which a current parts from that of the same motion without contact.

    From a sample `first` on it has to be `DEPARTS` above for `PARTED` samples, or to the end, as a
    mean of 21; NaN where it never does.  The shorter current decides how far they are compared.
    """
    both = min(len(contact), len(free))
    apart = smooth(contact[:both] - free[:both], 21)[first:] > DEPARTS
    runs = np.convolve(np.append(apart, np.ones(PARTED - 1)), np.ones(PARTED), mode="valid")
    began = apart & (runs > PARTED - 0.5)
    return PERIOD * (first + int(np.argmax(began))) if began.any() else float("nan")


def detected(values: np.ndarray, first: int, last: int, rules: ContactSettings) -> float:
    """Time [s] at which a contact is declared between two samples; NaN where none is."""
    detector = ContactDetector(rules, PERIOD)
    for k in range(first, last):
        if detector.update(float(values[k])) is not None:
            return PERIOD * k
    return float("nan")
