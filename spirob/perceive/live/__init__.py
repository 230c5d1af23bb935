"""Perception from a bus while it happens; it listens and says nothing on the bus.

grid.py        feedback as it arrives -> samples at equal distances in time
motion.py      when a motor begins to move
live_wrap.py   a wrap as it grows, and when it is over
live_push.py   pushes of an arm whose motors hold their currents
watch.py       contact, size and pushes from frames
"""

from spirob.perceive.live.live_push import LivePush
from spirob.perceive.live.watch import Told, Watch

__all__ = ["LivePush", "Told", "Watch"]
