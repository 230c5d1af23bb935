"""The places where effects act, in the order of a cycle, and the signals that effects may read.

Signs, once for the whole program: positive current and torque wind the tendon in; Δl = ℓ(0) - ℓ(q)
is positive when the tendon is shortened; tension is positive when it pulls; a positive hinge angle
bends the arm to the left (+y), which shortens the left tendon.

A port combines its effects in one of two ways.  `sum`: it starts at zero and effects add.  `pipe`:
each effect maps the value that comes from upstream, in the order in which the effects are listed.
If an effect cannot be written without naming it in `plant/`, a port is missing here.

Effects are not bound to this arm.  Over the trace of a servo or a linear drive the same kernels
read the same signals (its speed in place of the rotor's, in its own unit); `motor.rest_speed` then
carries the scale, so that no kernel holds a speed of its own.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Port:
    """One place where effects act.

    each   what the kernel runs for: every "motor", every "hinge", every "guide" (each hinge of each
           tendon, from base to tip), or the "arm" as a whole
    every  when it runs: each "step" of the physics, each "cycle" of the bus (a kernel's `dt` is the
           length of that), or "once", when the body is built
    span   lowest and highest plausible value from upstream, in which effects are checked
    """

    unit: str
    combine: str
    each: str
    meaning: str
    every: str = "step"
    span: tuple[float, float] = (0.0, 0.0)


PORTS = {
    "command.current": Port(
        "A",
        "pipe",
        "motor",
        "commanded current as the drive understands it",
        "cycle",
        span=(-20.0, 20.0),
    ),
    "motor.supply": Port(
        "V", "pipe", "motor", "supply voltage, the limit of the drive's output", span=(1.0, 100.0)
    ),
    "motor.resistance": Port("Ω", "pipe", "motor", "winding resistance R", span=(0.01, 20.0)),
    "motor.voltage": Port("V", "sum", "motor", "disturbance voltage d in the R-L circuit"),
    "motor.drive_torque": Port(
        "N·m", "pipe", "motor", "torque k_t·i at the rotor", span=(-2.0, 2.0)
    ),
    "motor.torque": Port("N·m", "sum", "motor", "torque added at the rotor, friction negative"),
    "winch.efficiency": Port("1", "pipe", "motor", "transmission efficiency η", span=(0.3, 1.0)),
    "winch.radius": Port("m", "pipe", "motor", "effective radius of the drum r", span=(0.001, 0.2)),
    "tendon.force": Port("N", "sum", "motor", "force on the winch beside the tendon's, + winds in"),
    "tendon.extra_length": Port("m", "sum", "motor", "length the tendon has gained (creep, play)"),
    "tendon.stiffness": Port(
        "N/m", "pipe", "motor", "tension per stretch of the tendon k", span=(5e3, 1e6)
    ),
    "tendon.tension_ratio": Port(
        "1", "pipe", "guide", "tension behind a guide over that at winch", span=(0.01, 3.0)
    ),
    "body.hinge_torque": Port("N·m", "sum", "hinge", "torque added at a hinge of the arm"),
    "body.tip_mass": Port("kg", "sum", "arm", "mass carried at the tip", "once"),
    "sensing.displacement": Port(
        "m",
        "pipe",
        "motor",
        "wound-in length as the encoder reports it; its rate follows",
        "cycle",
        span=(-0.4, 0.4),
    ),
    "sensing.current": Port(
        "A",
        "pipe",
        "motor",
        "motor current as the drive's sensor reads it; the drive regulates this reading",
        "cycle",
        span=(-20.0, 20.0),
    ),
    "sensing.report": Port(
        "A", "pipe", "motor", "current reading as the drive reports it", "cycle", span=(-20.0, 20.0)
    ),
    "sensing.frame": Port(
        "reading",
        "pipe",
        "motor",
        "each reading of the feedback frame in turn",
        "cycle",
        span=(-100.0, 100.0),
    ),
}


@dataclass(frozen=True)
class Signal:
    """One quantity that a kernel may read; `each` as for ports.

    span   lowest and highest plausible value, in which effects are checked
    given  true where it belongs to the machine and does not change in a trial
    """

    unit: str
    each: str
    meaning: str
    span: tuple[float, float]
    given: bool = False


SIGNALS = {
    "time": Signal("s", "trial", "time since the trial began", (0.0, 100.0)),
    "motor.rest_speed": Signal(
        "rad/s",
        "trial",
        "speed below which this rig counts as standing: the scale of a smooth sign",
        (0.001, 10.0),
        given=True,
    ),
    "motor.command": Signal("A", "motor", "commanded current", (-20.0, 20.0)),
    "motor.current": Signal("A", "motor", "motor current i*", (-20.0, 20.0)),
    "motor.speed": Signal("rad/s", "motor", "rotor speed, + winds in", (-1000.0, 1000.0)),
    "motor.angle": Signal(
        "rad", "motor", "rotor angle, whole turns counted from the start", (-10000.0, 10000.0)
    ),
    "motor.load_torque": Signal(
        "N·m", "motor", "tendon's torque r·F/G seen by the rotor", (-1.0, 1.0)
    ),
    "motor.inertia_torque": Signal(
        "N·m",
        "motor",
        "part of the load torque that accelerates what may be the motor's own; none in the arm",
        (-1.0, 1.0),
    ),
    "motor.power": Signal("W", "motor", "electrical power that the motor draws", (-500.0, 500.0)),
    "winch.angle": Signal("rad", "motor", "drum angle since the start of the trial", (-50.0, 50.0)),
    "winch.displacement": Signal("m", "motor", "wound-in length x", (-0.4, 0.4)),
    "winch.velocity": Signal("m/s", "motor", "rate of the wound-in length", (-2.0, 2.0)),
    "tendon.tension": Signal("N", "motor", "tension at the winch", (0.0, 300.0)),
    "tendon.stretch": Signal(
        "m", "motor", "wound-in length beyond what the arm has given", (-0.02, 0.05)
    ),
    "guide.sliding": Signal(
        "m/s", "guide", "speed of the tendon through a guide, + towards base", (-2.0, 2.0)
    ),
    "hinge.angle": Signal("rad", "hinge", "angle of a hinge", (-0.6, 0.6)),
    "hinge.speed": Signal("rad/s", "hinge", "angular speed of a hinge", (-50.0, 50.0)),
    "hinge.stiffness": Signal(
        "N·m/rad", "hinge", "linear stiffness of a hinge", (0.001, 2.0), given=True
    ),
    "hinge.weight_x": Signal(
        "N·m",
        "hinge",
        "torque of the weight beyond a hinge if gravity pointed along the arm, +x",
        (-1.0, 1.0),
    ),
    "hinge.weight_y": Signal(
        "N·m",
        "hinge",
        "torque of the weight beyond a hinge if gravity pointed to the left, +y",
        (-1.0, 1.0),
    ),
}

READABLE = {  # what a port of each kind may read
    "motor": {"trial", "motor"},
    "hinge": {"trial", "hinge"},
    "guide": {"trial", "motor", "hinge", "guide"},
    "arm": set(),
}
