"""Look at a CAN bus before the first motion.

`scan` only listens: which interfaces there are, which frames are on one. `check` commands zero
current at 1 kHz and measures rates, lost frames, delays and clocks; it never arms the robot.
"""

import argparse

from spirob.errors import ConfigError

HELP = "scan a CAN bus, or check it at zero current before the first motion"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    scan = actions.add_parser("scan", help="list interfaces, or what is heard on one")
    check = actions.add_parser("check", help="rates, lost frames, delays and clock at zero current")
    for one in (scan, check):
        one.add_argument("--interface", help="of python-can: socketcan, pcan, udp_multicast ...")
        one.add_argument("--channel", default="can0", help="such as can0 or PCAN_USBBUS1")
        one.add_argument("--bitrate", type=int, default=1_000_000, help="bit/s")
        one.add_argument("--seconds", type=float, default=2.0, help="how long to listen or play")
    check.add_argument(
        "--drive", default="c620", help="c620, odrive, gm6020, or a description of your own"
    )


def run(arguments: argparse.Namespace) -> int:
    """Do what was asked."""
    if not 0.05 <= arguments.seconds <= 600:
        raise ConfigError(f"--seconds {arguments.seconds:g} is out of range [0.05, 600]")
    return {"scan": _scan, "check": _check}[arguments.action](arguments)


def _scan(arguments: argparse.Namespace) -> int:
    import logging

    import can

    from spirob.can.bus import listen, open_bus
    from spirob.can.drive import find_drive

    if arguments.interface is None:
        logging.disable(logging.CRITICAL)  # python-can tells of every absent driver
        found_here = can.detect_available_configs()
        logging.disable(logging.NOTSET)
        for found in found_here:
            print(f"{found['interface']:16} {found['channel']}")
        print("listen on one with: spirob can scan --interface INTERFACE --channel CHANNEL")
        return 0
    bus = open_bus(arguments.interface, arguments.channel, arguments.bitrate)
    try:
        heard = listen(bus, arguments.seconds, [find_drive("odrive"), find_drive("gm6020")])
    finally:
        bus.shutdown()
    for one in heard:
        sizes = "/".join(map(str, one.sizes))
        print(
            f"{one.number:#x}{' extended' * one.extended}  {one.rate:.1f}/s  "
            f"longest pause {1e3 * one.pause:.1f} ms  {sizes} bytes  {one.meaning}".rstrip()
        )
    if not heard:
        print(f"nothing was heard in {arguments.seconds:g} s: check bit rate, plug and terminator")
    return 0


def _check(arguments: argparse.Namespace) -> int:
    from spirob.can.bus import check, open_bus
    from spirob.can.drive import find_drive, require_fast_enough
    from spirob.can.robot import CanRobot

    if arguments.interface is None:
        raise ConfigError("`spirob can check` needs --interface; `spirob can scan` lists them")
    drive = None if arguments.drive == "c620" else find_drive(arguments.drive)
    if drive and drive.by_voltage:
        require_fast_enough(drive, arguments.bitrate)
    bus = open_bus(arguments.interface, arguments.channel, arguments.bitrate)
    robot = CanRobot(bus, silence_ns=500_000_000, drive=drive, urgent=True)
    try:
        found = check(robot, arguments.seconds, drive)
    finally:
        robot.close()
    if drive and drive.by_voltage:
        print(f"{drive.about.name} takes voltages: zero volts were sent, the host closes the loop")
    for motor, rate in found.rate.items():
        print(
            f"{motor}: {rate:.1f} feedback frames/s, {100 * found.lost[motor]:.2f} % lost; "
            f"cycles without: at most {found.longest[motor]} in a row; "
            f"delay {_micro(found.delay[motor])}"
        )
    print(f"cycles: {found.cycles}, {found.skipped} skipped; lateness {_micro(found.lateness)}")
    print(f"clock: {1e6 * found.drift:+.0f} ppm against the wall clock")
    if robot.urgency and robot.urgency.lacking:
        print(f"note: {robot.urgency.lacking}")
    for fault in found.faults:
        print(f"not ready: {fault}")
    print("ready to be armed" if not found.faults else "do not arm")
    return 0 if not found.faults else 2


def _micro(spread: tuple[float, ...]) -> str:
    p50, p99, most = (1e6 * value for value in spread)
    return f"{p50:.0f} µs (99 %: {p99:.0f}, most: {most:.0f})"
