"""`python -m spirob.emulator`: the emulated robot as a process on a real or a network bus.

The rehearsal for a laboratory: it answers `conf/robot/can.yaml` exactly as drives would.

    python -m spirob.emulator --interface udp_multicast --channel 239.74.163.2 --seconds 60
"""

import argparse
import signal
import sys

import can

from spirob.can_protocol import require_interface
from spirob.emulator.build import BUILDS, TYPICAL
from spirob.emulator.machine import Machine
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.emulator.robot import serve
from spirob.ending import end_with_parent
from spirob.errors import SpirobError


def main(arguments: list[str] | None = None) -> int:
    """Serve until the time is over; 2 where the bus cannot be opened."""
    parser = argparse.ArgumentParser(prog="spirob.emulator", description=__doc__)
    parser.add_argument("--interface", default="udp_multicast", help="of python-can")
    parser.add_argument("--channel", default="239.74.163.2", help="of that interface")
    parser.add_argument("--seconds", type=float, default=3600.0, help="how long to serve")
    parser.add_argument("--hidden", default="none", help="what the model does not know")
    parser.add_argument("--build", default=TYPICAL, choices=BUILDS, help="how it is built")
    parser.add_argument("--seed", type=int, default=1, help="which machine of its kind")
    parser.add_argument(
        "--drive", default="c620", choices=("c620", "gm6020"), help="gm6020 takes voltages"
    )
    chosen = parser.parse_args(arguments)
    try:
        require_interface(chosen.interface, f"CAN bus {chosen.interface}:{chosen.channel}")
        settings = HiddenSettings(chosen.hidden, build=chosen.build)
        rig = EmulatedRig(by_voltage=chosen.drive == "gm6020")
        machine = Machine(rig, settings, chosen.seed)
        print("compiling, the first time for half a minute", file=sys.stderr, flush=True)
        machine.cycle((0.0, 0.0))  # compiled before time counts
        with can.Bus(interface=chosen.interface, channel=chosen.channel) as bus:
            print(f"serving on {chosen.interface}:{chosen.channel}", flush=True)
            dropped = serve(bus, machine, chosen.seconds)
    except (SpirobError, can.CanError, OSError, ImportError) as error:
        print(f"spirob.emulator: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    print(f"{dropped} cycles without a word, because the computer was late")
    return 0


if __name__ == "__main__":
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # not under nohup
        end_with_parent()
    sys.exit(main())
