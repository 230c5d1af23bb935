"""Opens a CAN bus through python-can, and says in a sentence why it cannot."""

from typing import Any

import can

from spirob.can_interface import require_interface
from spirob.errors import HardwareError

BITRATE = 1_000_000  # of C620-style drives; a wrong rate sends the bus into error, not the drive


def open_bus(interface: str, channel: str, bitrate: int = BITRATE, **options: Any) -> can.BusABC:
    """An open bus; `interface`, `channel` and further options are python-can's own.

    interface  e.g. "pcan", "socketcan", "virtual";  channel e.g. "PCAN_USBBUS1", "can0"
    bitrate    [bit/s]; socketcan takes it from the system, where it is set with `ip link`

    Raises HardwareError naming the interface, the channel, and what to install.
    """
    what = f"CAN bus {interface}:{channel}"
    require_interface(interface, what)
    try:
        bus = can.Bus(interface=interface, channel=channel, bitrate=bitrate, **options)
    except (can.CanError, OSError, ImportError, ValueError, TypeError, NameError) as error:
        raise HardwareError(f"{what} cannot be opened: {error}") from error
    if bus.channel_info == can.BusABC.channel_info:  # not every interface names itself
        bus.channel_info = f"{interface}:{channel}"
    return bus
