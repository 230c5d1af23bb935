"""Limits that no command may leave and that stop a trial when the machine does."""

from spirob.parameter import Numbers, bounded


class Limits(Numbers):
    """Wide defaults, which the drive itself nearly keeps; a real robot's configuration has its own.

    Commands beyond `current` and `slew`, and voltages beyond theirs, are brought back to them;
    anything else stops the trial.
    `speed` times `silence` should stay below half a rotor turn, so that lost frames cannot hide
    a whole one.
    """

    owner = "safety"

    current: float = bounded(20.0, 0.01, 20.0, "A", "i_max", "size of a commanded current")
    slew: float = bounded(4e4, 1.0, 1e6, "A/s", "s_max", "rate of a commanded current")
    voltage: float = bounded(24.0, 0.1, 24.0, "V", "u_max", "size of a commanded voltage")
    voltage_slew: float = bounded(4.8e4, 1.0, 1e6, "V/s", "u̇_max", "rate of a commanded voltage")
    travel: float = bounded(1.0, 0.001, 10.0, "m", "x_max", "wound-in length since the start")
    speed: float = bounded(5.0, 0.001, 100.0, "m/s", "v_max", "speed of a tendon")
    temperature: float = bounded(100.0, 30.0, 150.0, "degC", "T_max", "winding, as reported")
    silence: float = bounded(0.010, 0.002, 1.0, "s", "t_s", "without feedback of a motor")
    following: float = bounded(1.0, 0.01, 40.0, "A", "e_max", "command less reported current")
    following_time: float = bounded(0.25, 0.005, 10.0, "s", "t_e", "for how long, at a stretch")
    frozen: float = bounded(0.05, 0.005, 10.0, "s", "t_f", "with bit-identical feedback")
