"""Tell contacts and sizes from a bus while the robot moves.

Watching only listens: nothing is sent, so it runs beside whatever drives the robot, on the emulator
as a process (python -m spirob.emulator) as on real drives.  A contact is told by the paper's three
rules on the raw current, from 0.7 s after a motion begins; a size when the tendon that wound in has
stood for a second; with --passive a push of an arm whose motors hold their currents, from 0.8 s on.
"""

import argparse
import sys
import time
from typing import TYPE_CHECKING

from spirob.errors import ConfigError, HardwareError

if TYPE_CHECKING:
    import can

    from spirob.can.drive import Drive
    from spirob.perceive.live import Watch

HELP = "tell contacts and sizes from a bus while the robot moves"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--interface", required=True, help="of python-can; `spirob can scan`")
    parser.add_argument("--channel", default="can0", help="such as can0 or PCAN_USBBUS1")
    parser.add_argument("--bitrate", type=int, default=1_000_000, help="bit/s")
    parser.add_argument("--drive", default="c620", help="c620, odrive, or a .yaml of your own")
    parser.add_argument("--gear", type=float, default=3591 / 187, help="rotor turns a winch turn")
    parser.add_argument("--radius", type=float, default=0.02, help="of the winch [m]")
    parser.add_argument(
        "--model",
        default="data/models/size.skops",
        metavar="FILE",
        help="trained model of sizes, or 'none' for contacts alone (default: %(default)s)",
    )
    parser.add_argument(
        "--passive",
        metavar="FILE",
        help="tell pushes of an arm under held currents, and where, by data/passive/regions.skops",
    )
    parser.add_argument("--motor", choices=("left", "right"), default="left", help="that wraps")
    parser.add_argument("--seconds", type=float, default=86400.0, help="or until Ctrl-C")


def run(arguments: argparse.Namespace) -> int:
    """Listen until the time is over."""
    from spirob.can.bus import open_bus
    from spirob.can.drive import find_drive
    from spirob.logs import Transmission
    from spirob.perceive.live import LivePush, Watch
    from spirob.perceive.model_file import load_model, load_regions

    if not 0.05 <= arguments.seconds <= 86400:
        raise ConfigError(f"--seconds {arguments.seconds:g} is out of range [0.05, 86400]")
    watch = Watch(
        Transmission(gear_ratio=arguments.gear, winch_radius=arguments.radius),
        model=None if arguments.model == "none" else load_model(arguments.model),
        wraps=arguments.motor,
        push=LivePush(load_regions(arguments.passive)) if arguments.passive else None,
    )
    drive = None if arguments.drive == "c620" else find_drive(arguments.drive)
    bus = open_bus(arguments.interface, arguments.channel, arguments.bitrate)
    try:
        show(watch, bus, arguments.seconds, drive)
    finally:
        bus.shutdown()
    return 0


EVERY = 0.2  # s, between two looks at the state
SILENCE = 2.0  # s without any feedback from a motor, at the start
CLEAR = "\r\x1b[K"


def show(watch: "Watch", bus: "can.BusABC", seconds: float, drive: "Drive | None" = None) -> None:
    """Listen and print; raises HardwareError where a motor is not heard at all."""
    from spirob.can.bus import heard

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


def state(watch: "Watch") -> str:
    """Both motors, the last size, and whether the arm is pushed, in one line."""
    from spirob.robot import MOTORS

    parts = []
    for motor, said, touched in zip(MOTORS, watch.states, watch.contact, strict=True):
        contact = "CONTACT" if touched else "free"
        parts.append(f"{motor} {said.current:+.2f} A {1e3 * said.displacement:+.1f} mm {contact}")
    pushed = ["PUSHED" if watch.push.felt else "not pushed"] if watch.push else []
    return "  ".join([*parts, f"size {watch.size or '–'}", *pushed])


def _require_feedback(watch: "Watch", bus: "can.BusABC", after: float) -> None:
    from spirob.robot import MOTORS

    silent = [m for m, frames in zip(MOTORS, watch.frames, strict=True) if frames == 0]
    if silent:
        raise HardwareError(
            f"{bus.channel_info}: no feedback from motor {' and '.join(silent)} in {after:.1f} s; "
            "`spirob can scan` tells what is on the bus"
        )
