"""The test of the diagnosis itself: robots with a hidden effect, diagnosed blind, and scored."""
