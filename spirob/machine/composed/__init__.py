"""A law for what the library lacks: composed from what a model leaves, and written as an effect."""

from spirob.machine.composed.composing import Composed, composed

__all__ = ["Composed", "composed"]
