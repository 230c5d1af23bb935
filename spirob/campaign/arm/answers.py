"""The answer key: what each hidden kind of the emulated robot is called in the library of effects.

Several names are equal in what they do to the logs of one rig, and each counts as right; "" is the
right answer where the kind cannot be told from a fitted number.  Only scoring reads this.
"""

ANSWERS: dict[str, tuple[str, ...]] = {
    "none": ("",),
    "asymmetric_viscous": ("asymmetric_viscous_friction",),
    "back_driving_loss": ("direction_dependent_efficiency", "load_dependent_friction"),
    "cogging": ("cogging",),
    "constant_pull": ("constant_force", "current_offset"),
    "current_gain": ("current_gain", ""),  # the efficiency takes it up
    "current_lag": ("current_lag", "feedback_latency"),
    "current_offset": ("current_offset", "constant_force"),
    "driver_dead_band": ("driver_dead_band",),
    "drum_build_up": ("drum_build_up", "eccentric_winch"),  # it is both: see TOGETHER
    "eccentric_drum": ("eccentric_winch",),
    "encoder_eccentricity": ("encoder_eccentricity",),
    "feedback_latency": ("feedback_latency", "current_lag"),
    "gear_backlash": ("backlash",),
    "gear_compliance": ("gear_compliance", "stretch"),
    "guide_friction": ("capstan_friction",),
    "joint_creep": ("joint_viscoelasticity",),
    "load_friction": ("load_dependent_friction", "direction_dependent_efficiency"),
    "magnetic_saturation": ("torque_constant_saturation",),
    "mount_tilt": ("mount_tilt",),
    "quadratic_drag": ("quadratic_drag",),
    "rest_curvature": ("rest_curvature",),
    "rotor_friction": ("coulomb_friction", "stribeck_friction", "presliding_friction"),
    "stiffness_hardening": ("stiffness_hardening",),
    "tendon_creep": ("creep",),
    "tendon_stretch": ("stretch", "gear_compliance"),
    "tight_spot": (),  # no name of the library is right
    "tip_payload": ("tip_payload",),
    "torque_ripple": ("torque_ripple",),
    "winding_heating": ("winding_heating",),
}

# Kinds that are several effects of the library at once, which the oracle knows together.  A drum on
# which layers pile up grows and runs out of true; a stroke of one turn shows the latter more.
TOGETHER: dict[str, tuple[str, ...]] = {"drum_build_up": ("drum_build_up", "eccentric_winch")}


def right(hidden: str, named: str) -> bool:
    """Whether the first name of a verdict ("" for none) answers what was hidden."""
    kinds = [part.split(":")[0] for part in hidden.split("+")]
    return any(named in ANSWERS.get(kind, ()) for kind in kinds)
