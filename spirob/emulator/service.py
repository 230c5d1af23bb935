"""The emulated robot in real time, as a process of its own on a bus that others share.

Every millisecond of the wall clock is one of the machine's, under the latest command that has come
by then; drives send their feedback whether or not they are spoken to, as real ones do.
"""

import time

import can

from spirob.emulator.faults import Wire
from spirob.emulator.machine import Machine
from spirob.emulator.node import DriveNode
from spirob.robot import CYCLE_NS

MOST = 1000  # cycles lived through at once
NAP_NS = 200_000  # before the deadline, where sleeping is not exact any more


def serve(bus: can.BusABC, machine: Machine, seconds: float, wire: Wire | None = None) -> int:
    """Run for some seconds of the wall clock; returns in how many cycles nobody was told anything.

    Where the computer is late, the machine still lives through the time: its drives only fail to
    speak.
    """
    wire = wire or Wire()
    wire.begin(machine.generator)
    node = DriveNode(bus, machine, wire)
    deadline = start = time.monotonic_ns()
    dropped = 0
    while deadline - start < seconds * 1e9:
        deadline += CYCLE_NS
        while (left := deadline - time.monotonic_ns()) > 0:
            if left > NAP_NS:
                time.sleep((left - NAP_NS) * 1e-9)
        missed = min(MOST, (time.monotonic_ns() - deadline) // CYCLE_NS)
        for _ in range(missed):
            node.cycle(silent=True)
        dropped += missed
        deadline += missed * CYCLE_NS
        wire.cycle(node.now_ns)
        node.cycle()
    return dropped
