"""Perception from a bus while it happens; it listens and says nothing on the bus.

grid.py        feedback as it arrives -> samples at equal distances in time
motion.py      when a motor begins to move
live_wrap.py   a wrap as it grows, and when it is over
watch.py       contact and size from frames
"""

from spirob.perceive.live.watch import Told, Watch

__all__ = ["Told", "Watch"]
