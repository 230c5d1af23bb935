"""The emulated robot: both ends of a virtual bus a cycle at a time, or a process on a shared bus.

The emulated robot in real time, as a process of its own on a bus that others share.

Every millisecond of the wall clock is one of the machine's, under the latest command that has come
by then; drives send their feedback whether or not they are spoken to, as real ones do.
"""

import itertools
import os
import time
from collections.abc import Mapping, Sequence
from typing import Any

import can
import numpy as np

from spirob.can_protocol import CanFrame
from spirob.emulator.faults import Wire, wire_from
from spirob.emulator.machine import Machine
from spirob.emulator.node import IDLE, SECOND_NS, DriveNode
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.errors import HardwareError
from spirob.robot import CYCLE_NS, Scene

_instances = itertools.count()


class EmulatedRobot:
    """A `Robot` whose hardware is computed.

    The controller's side of the bus is a real python-can bus; only the node behind it knows that
    no steel is there.

        robot = EmulatedRobot(EmulatedRig(), HiddenSettings("guide_friction", 1.0), seed=7)
        robot.prepare(Scene(), "extreme_curl_1")
        frames = robot.exchange(encode_command((0.5, 0.1)))

    faults  what goes wrong on the way, as plain data (see `spirob.emulator.faults`)
    """

    def __init__(
        self,
        rig: EmulatedRig | None = None,
        hidden: HiddenSettings | None = None,
        seed: int = 0,
        faults: Sequence[Mapping[str, Any]] = (),
    ):
        self.machine = Machine(rig or EmulatedRig(), hidden or HiddenSettings(), seed)
        channel = f"spirob-emulator-{os.getpid()}-{next(_instances)}"
        self._bus = _virtual_bus(channel)
        self._node_bus = _virtual_bus(channel)
        self._wire = wire_from(faults)
        self.node = DriveNode(self._node_bus, self.machine, self._wire)
        self._open = True
        self._begin("trial")

    def prepare(self, scene: Scene, trial: str = "trial") -> None:
        """Bring the arm to rest in this scene, at simulated time zero.

        trial  name that, with the seed, decides the noise and the rotors' first angles
        """
        self._require_open()
        self.machine.start(scene, trial)
        self._begin(trial)

    def _begin(self, trial: str) -> None:
        self.node.begin()
        self._wire.begin(lambda name: self.machine.generator(f"{name} of trial {trial}"))

    def exchange(self, command: bytes) -> list[CanFrame]:
        """Send one command payload; returns it and the feedback of the cycle that it ruled.

        With faults more or fewer than two may come back.

        Raises HardwareError when the machine's state is lost; its currents are then zero, because
        it stands still until it is prepared again.
        """
        self._require_open()
        sent = CanFrame(self.node.now_ns, self.node.command_id, bytes(command))
        self._wire.cycle(sent.stamp_ns)
        for frame in self._wire.commands([sent]):
            self._bus.send(_message(frame))
        self.node.cycle()
        arrived = []
        while (message := self._bus.recv(timeout=0)) is not None:
            stamp = round(message.timestamp * SECOND_NS)
            arrived.append(CanFrame(stamp, message.arbitration_id, bytes(message.data)))
        return [sent, *self._wire.feedback(arrived)]

    def truth(self) -> dict[str, Any]:
        """What a real machine would never tell: its hidden effects and its true numbers.

        Plain numbers, lists and strings; only scoring may read them.
        """
        machine = self.machine
        bus = {"bus_latency": machine.latency.mean} if machine.latency else {}
        fields = machine.numbers.dtype.names or ()
        return {
            "seed": machine.seed,
            "effect": machine.settings.effect,
            "strength": machine.settings.strength,
            "hidden": [effect.plain for effect in machine.hidden],
            "drawn": {name: value.tolist() for name, value in machine.drawn.items()},
            "build": {
                "name": machine.settings.build,
                "rows": {name: value.tolist() for name, value in machine.build.rows.items()},
            },
            "numbers": {
                name: np.asarray(machine.numbers[name][0]).tolist()
                for name in fields
                if not name.startswith("source_")
            },
            **bus,
        }

    def close(self) -> None:
        """Command zero current and release the bus; safe to call twice."""
        if self._open:
            self._open = False
            self._bus.send(_message(CanFrame(self.node.now_ns, self.node.command_id, IDLE)))
            self._bus.shutdown()
            self._node_bus.shutdown()

    def _require_open(self) -> None:
        if not self._open:
            raise HardwareError("emulated robot: the bus is closed; make a new robot")


def _message(frame: CanFrame) -> can.Message:
    return can.Message(
        timestamp=frame.stamp_ns / SECOND_NS,
        arbitration_id=frame.arbitration_id,
        is_extended_id=False,
        data=frame.data,
    )


def _virtual_bus(channel: str) -> can.BusABC:
    return can.Bus(interface="virtual", channel=channel, preserve_timestamps=True)


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
