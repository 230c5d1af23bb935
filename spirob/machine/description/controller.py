"""The law of a controller that a log was made under: what it asks for."""

from typing import Literal

import numpy as np
from pydantic import Field, model_validator
from scipy.integrate import cumulative_trapezoid

from spirob.machine.description.columns import Entry


class Control(Entry):
    """What the controller asks for, in the unit of effort, from position and speed in SI.

    u = kp·(reference - q) + kd·w + ki·∫(reference - q), or a cascade
    u = velocity·e + integral·∫e  with  e = position·(reference - q) + w;  no more than ± limit

    rate  what w is: "speed", w = -v, or "error", w = d(reference - q)/dt
    """

    position: float | None = None
    velocity: float | None = None
    integral: float = 0.0
    kp: float | None = None
    kd: float = 0.0
    ki: float = 0.0
    rate: Literal["speed", "error"] = "speed"
    limit: float | None = Field(default=None, gt=0)

    @model_validator(mode="after")
    def _one_form(self) -> "Control":
        cascade = self.position is not None and self.velocity is not None
        if cascade == (self.kp is not None):
            raise ValueError("give position and velocity of a cascade, or kp, kd and ki")
        if not any(self.gains[:3]):
            raise ValueError("with gains of 0 a controller asks for nothing")
        return self

    @property
    def gains(self) -> tuple[float, float, float, float, float, float]:
        """(P, D, I, a, b, c) of u = P·(r - q) + D·w + I·∫(a·(r - q) + b·w),  w = c·dr/dt - v."""
        led = float(self.rate == "error")
        if self.kp is not None:
            return self.kp, self.kd, self.ki, 1.0, 0.0, led
        position, velocity = self.position or 0.0, self.velocity or 0.0
        return velocity * position, velocity, self.integral, position, 1.0, led

    def asked(
        self, wrong: np.ndarray, pace: np.ndarray, v: np.ndarray, period: float
    ) -> np.ndarray:
        """The effort, in its own unit, along a piece of a log.

        wrong  reference - q;  pace  dr/dt;  (n,) each
        """
        p, d, i, a, b, c = self.gains
        rate = c * pace - v
        wound = cumulative_trapezoid(a * wrong + b * rate, dx=period, initial=0.0)
        most = np.inf if self.limit is None else self.limit
        return np.clip(p * wrong + d * rate + i * np.asarray(wound), -most, most)
