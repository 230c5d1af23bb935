"""A law for what the library lacks: composed from what a model leaves, and written as an effect.

ground.py             what is left, of a rig and of the arm, and how a torque would show
track.py              the signals that a law may read
terms.py, grammar.py  terms, the shapes that it is made of; those from which it may begin
draft.py, greedy.py   terms beside a fitted model; one added after the other
law.py                a draft as a law of its own
composing.py, arm.py  all of this of a rig, and of the arm
writing.py            as an effect file, and in words
"""

from spirob.machine.composed.composing import Composed, composed

__all__ = ["Composed", "composed"]
