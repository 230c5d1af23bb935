"""What holds the model to a measured motion, beside the measured current.

    i = i_measured + K_v (v_measured - v + K_x (x_measured - x))

The second part is zero where the model is right: the measured current moves it as the machine was
moved.  Where it is wrong, it is the current by which the model errs, behind a low-pass of the
bandwidth ω = K_v n/m, with n newton an ampere and m kilograms at the drum.

There is no integral.  The law takes i_measured as an error of the speed, i/K_v, and an integral
would add it up; it then rings, and fits with numbers that make up for it left twenty times as much.
"""

from spirob.control.law import Gains
from spirob.plant import Rig

# As fast as the controller of the machine's own trials, from which the sizes of effects are known.
# Two rotors swing on their tendons at 33 rad/s, with hardly a loss; a stiff follower leaves that to
# them, and the model's error rings on.
BANDWIDTH = 30.0  # rad/s
SLOWER = 0.25  # of the bandwidth: position is corrected without a swing


def following(rig: Rig) -> Gains:
    """The gains for the rig's nominal numbers."""
    winch, motor = rig.winch, rig.motor
    turning = motor.rotor_inertia * winch.gear_ratio**2 + winch.drum_inertia
    mass = turning / winch.radius**2
    newton = winch.efficiency * winch.gear_ratio * motor.torque_constant / winch.radius
    return Gains(velocity=BANDWIDTH * mass / newton, integral=0.0, displacement=SLOWER * BANDWIDTH)
