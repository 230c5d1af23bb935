"""What `spirob watch` shows: a line for each thing told, and on a terminal the present state."""

import sys
import time

import can

from spirob.canbus.bus import heard
from spirob.drives import Drive
from spirob.errors import HardwareError
from spirob.perceive.live import Watch
from spirob.robot import MOTORS

EVERY = 0.2  # s, between two looks at the state
SILENCE = 2.0  # s without any feedback from a motor, at the start
CLEAR = "\r\x1b[K"


def show(watch: Watch, bus: can.BusABC, seconds: float, drive: Drive | None = None) -> None:
    """Listen and print; raises HardwareError where a motor is not heard at all."""
    live = sys.stdout.isatty()
    begun = time.monotonic()
    shown = 0.0
    silent = True
    for frame in heard(bus, seconds, drive):
        for told in watch.take(frame) if frame else ():
            line = f"{told.seconds:8.3f} s  {told.motor:5}  {told.kind}: {told.text}"
            print((CLEAR if live else "") + line, flush=True)
        if silent and all(watch.frames):
            silent = False
            print(f"both motors are heard on {bus.channel_info}", flush=True)
        now = time.monotonic() - begun
        if now - shown > EVERY:
            shown = now
            if now > SILENCE:
                _require_feedback(watch, bus, now)
            if live:
                print(CLEAR + state(watch), end="", flush=True)
    _require_feedback(watch, bus, time.monotonic() - begun)
    if live:
        print()


def state(watch: Watch) -> str:
    """Both motors, the last size, and whether the arm is pushed, in one line."""
    parts = []
    for motor, said, touched in zip(MOTORS, watch.states, watch.contact, strict=True):
        contact = "CONTACT" if touched else "free"
        parts.append(f"{motor} {said.current:+.2f} A {1e3 * said.displacement:+.1f} mm {contact}")
    pushed = ["PUSHED" if watch.push.felt else "not pushed"] if watch.push else []
    return "  ".join([*parts, f"size {watch.size or '–'}", *pushed])


def _require_feedback(watch: Watch, bus: can.BusABC, after: float) -> None:
    silent = [m for m, frames in zip(MOTORS, watch.frames, strict=True) if frames == 0]
    if silent:
        raise HardwareError(
            f"{bus.channel_info}: no feedback from motor {' and '.join(silent)} in {after:.1f} s; "
            "`spirob can scan` tells what is on the bus"
        )
