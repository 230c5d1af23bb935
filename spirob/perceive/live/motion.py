"""When a motor begins to move, or turns round: what resets a contact detector."""

from spirob.robot import CYCLE_NS

MOVES = 5e-3  # m/s
RESTS = 2e-3  # m/s
SUSTAINED = 20e6 / CYCLE_NS  # samples; a drive's speed is noisy


class Motion:
    """Which way a motor moves: +1 winds in, -1 pays out, 0 rests."""

    def __init__(self) -> None:
        self.direction = 0
        self._candidate = 0
        self._held = 0

    def begins(self, velocity: float) -> bool:
        """Take in one sample [m/s]; whether a new motion begins with it."""
        if abs(velocity) < RESTS:
            now = 0
        elif abs(velocity) > MOVES:
            now = 1 if velocity > 0 else -1
        else:
            now = self.direction
        self._held = self._held + 1 if now == self._candidate else 1
        self._candidate = now
        if now == self.direction or self._held < SUSTAINED:
            return False
        self.direction = now
        return now != 0
