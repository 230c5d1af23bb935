"""Geometry of a tendon at one hinge, in closed form.

The guides before and after hinge i are at fixed distances ρ_b, ρ_a from it; the straight arm sees
them at the angle β.  The length between them depends on that hinge alone,

    ℓ(q)² = ρ_b² + ρ_a² - 2 ρ_b ρ_a cos(β - σ q),        σ = +1 for the left tendon, -1 right,

so the tendon's Jacobian needs no kinematics of the chain.  Between the faces of one unit its
length is constant.
"""

import math


def half_angle(q):
    """sin(q/2), cos(q/2): all that the guides of both tendons need of a hinge angle."""
    return math.sin(0.5 * q), math.cos(0.5 * q)


def guide_length(side, sine, cosine, product, gap_squared, sine_open, cosine_open):
    """Length between the guides [m] and its shortening per bend -dℓ/d(σq) [m/rad].

    side             σ;  sine, cosine  of q/2
    product          ρ_b·ρ_a [m²];  gap_squared  (ρ_b - ρ_a)² [m²]
    sine_open, cosine_open  of β/2

    With h = (β - σq)/2, ℓ² = (ρ_b - ρ_a)² + 4ρ_bρ_a sin²h, which keeps its digits where the guides
    nearly meet.  Beyond σq = β they have met: the length stays, and the tendon turns the hinge no
    further (an impact may carry it there for a step).
    """
    sine_half = max(0.0, sine_open * cosine - side * cosine_open * sine)
    cosine_half = cosine_open * cosine + side * sine_open * sine
    length = math.sqrt(gap_squared + 4.0 * product * sine_half * sine_half)
    return length, 2.0 * product * sine_half * cosine_half / length
