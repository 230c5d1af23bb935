"""The numbers of the arm that are fitted where nobody chooses others."""

FITTED = (
    "winch.efficiency",
    "motor.rotor_damping",
    "motor.rotor_inertia",
    "arm.base_stiffness",
    "arm.damping_time",
    "arm.bends_per_hinge",
    "tendon.stiffness",
    "winch.efficiency_difference",
    "motor.rotor_damping_difference",
    "motor.rotor_inertia_difference",
)
