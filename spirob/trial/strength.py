"""How strong a hidden effect is drawn, so that naming it is neither trivial nor impossible.

The strength is drawn so that knowing the effect would bring the held-out error to between 0.3 and
0.9 of what it is without: from √(f² + (v s)²) to f, where f is what is left with nothing hidden and
v what the effect leaves at strength 1 after all numbers of the model are fitted.
"""

import numpy as np

LEFT = 0.35  # % of the current RMS with nothing hidden
RATIOS = (0.3, 0.9)  # of the errors with and without knowing
LARGEST = 3.0  # strength

# % of the current's RMS that strength 1 leaves after the model's numbers are fitted, mean of three
# robots: docs/emulator.md, "What the logs show"
VISIBLE = {
    "asymmetric_viscous": 4.0,
    "back_driving_loss": 7.3,
    "cogging": 11.9,
    "constant_pull": 7.7,
    "current_gain": 0.5,
    "current_lag": 7.3,
    "current_offset": 11.6,
    "driver_dead_band": 3.6,
    "drum_build_up": 1.5,
    "eccentric_drum": 5.0,
    "encoder_eccentricity": 8.6,
    "feedback_latency": 1.6,
    "gear_backlash": 4.8,
    "gear_compliance": 3.0,
    "guide_friction": 4.2,
    "joint_creep": 2.0,
    "load_friction": 7.3,
    "magnetic_saturation": 3.6,
    "mount_tilt": 1.9,
    "quadratic_drag": 2.7,
    "rest_curvature": 1.3,
    "rotor_friction": 10.5,
    "stiffness_hardening": 2.0,
    "tendon_creep": 2.5,
    "tendon_stretch": 12.0,
    "tip_payload": 2.5,
    "torque_ripple": 6.4,
    "winding_heating": 1.5,
}


def drawn_strength(kind: str, rng: np.random.Generator) -> float:
    """A strength for a kind of the emulator; 1 where nothing is hidden."""
    ratio = float(rng.uniform(*RATIOS))
    if kind == "none":
        return 1.0
    return float(min(LARGEST, LEFT * np.sqrt(ratio**-2 - 1.0) / VISIBLE[kind]))
