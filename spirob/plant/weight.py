"""What the arm weighs at each of its hinges.

For a chain of units with mass m_i and length l_i, direction u_i and centre of mass at l_i/2, the
first moment of all that hinge i carries is

    S_i = (m_i/2 + M_(i+1)) l_i u_i + S_(i+1),      M_i = m_i + M_(i+1),

with the mass at the tip as M_(N+1).  Gravity g then turns the hinge by the moment S_i × g.
"""

import math


def hinge_weights(angles, units, weight):
    """Fill weight (N, 2) [N·m]: torque at each hinge if gravity pointed along +x, along +y.

    angles (N,) of the hinges [rad];  units (N + 1, 2) mass [kg] and length [m], the tip's mass last
    """
    hinges = weight.shape[0]
    direction = 0.0
    for i in range(hinges):
        direction += angles[i]
    beyond = units[hinges, 0]
    moment_x = 0.0
    moment_y = 0.0
    for i in range(hinges - 1, -1, -1):
        lever = (0.5 * units[i, 0] + beyond) * units[i, 1]
        moment_x += lever * math.cos(direction)
        moment_y += lever * math.sin(direction)
        weight[i, 0] = -9.80665 * moment_y  # standard gravity [m/s²]
        weight[i, 1] = 9.80665 * moment_x
        beyond += units[i, 0]
        direction -= angles[i]
