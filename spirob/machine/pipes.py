"""From a wanted torque back to the effort that makes it: P(e) = wanted, P the pipes between them.

P is a torque constant that saturates or ripples, an efficiency, a dead band: a function of samples,
(n,) to (n,), that may remember.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

PASSES = 12  # of the solution
SHRINKS = 0.5  # what is missed after a pass, over before: above, the step is too short
SOLVED = 1e-12  # of the largest effort
SHORT = 1e-3  # of the RMS effort: a step to either side for the slope of P
LEAST = 0.1  # of its torque that an ampere counts for: where iron is full, it gives next to none
Pipes = Callable[[np.ndarray], np.ndarray]


def nearby(passed: Pipes, wanted: np.ndarray, effort: np.ndarray) -> np.ndarray:
    """e + (wanted - P(e))/P', a Newton step from an effort e that was measured, (n,)."""
    return tangent(passed, effort).reached(wanted)


@dataclass(frozen=True)
class Tangent:
    """P about an effort e, (n,) each: P(e) `there`, and P'."""

    effort: np.ndarray
    there: np.ndarray
    slope: np.ndarray

    def reached(self, wanted: np.ndarray) -> np.ndarray:
        """e + (wanted - P(e))/P', (n,)."""
        return np.asarray(self.effort + (wanted - self.there) / self.slope)


def tangent(passed: Pipes, effort: np.ndarray) -> Tangent:
    """P' is the slope at e; where P is flat, in a dead band, a secant over the RMS effort."""
    far = float(np.sqrt(np.mean(effort**2))) or 1.0
    slope = _slope(passed, effort, SHORT * far)
    if np.any(flat := slope == 0.0):
        slope = np.where(flat, _slope(passed, effort, far), slope)
    return Tangent(effort, passed(effort), np.maximum(slope, LEAST))


def _slope(passed: Pipes, effort: np.ndarray, step: float) -> np.ndarray:
    """A secant of P over a step of the effort either way, (n,)."""
    return np.asarray((passed(effort + step) - passed(effort - step)) / (2.0 * step))


def solved(passed: Pipes, wanted: np.ndarray) -> np.ndarray:
    """e with P(e) = wanted, (n,), by secants from e = wanted.

    Where an effort changes nothing, in a dead band, the steps grow until it does; a secant over
    its edge is of no use there.
    """
    effort = wanted
    close = SOLVED * np.max(np.abs(wanted))
    step, missed = np.ones_like(effort), np.full_like(effort, np.inf)
    moved, edges = np.zeros_like(effort), np.zeros(len(effort), bool)
    for _ in range(PASSES):
        miss = wanted - passed(effort)
        if np.max(np.abs(miss)) <= close:
            break
        flat = (np.sign(miss) == np.sign(missed)) & (np.abs(miss) > SHRINKS * np.abs(missed))
        edges |= flat
        smooth = np.where(edges, 1.0, _secant(moved, missed - miss))
        step = np.where(flat, 2.0 * step, smooth)
        moved, missed = step * miss, miss
        effort = effort + moved
    return effort


def _secant(moved: np.ndarray, gained: np.ndarray) -> np.ndarray:
    """Step for each unit that is missed, from the last move and its gain; 1 where far from it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = moved / gained
    return np.where((steps > SHRINKS) & (steps < 1.0 / SHRINKS), steps, 1.0)
