"""The emulated robot: both ends of a virtual bus a cycle at a time, or a process on a shared bus.

The drives' end takes a command frame, one millisecond of physics passes, and feedback goes out.

Time is the machine's own and in lockstep with the commands: cycle k runs from k ms to k+1 ms, the
command carries the stamp of its start, the feedback that of its end, and nothing depends on when
the computer got round to it.  In a cycle without a command the last one holds, but not for ever:
drives stop by themselves when nobody speaks to them.  C620-style drives take currents; those of a
machine in voltage mode are GM6020-style and take voltages.

As a process of its own on a bus that others share, every millisecond of the wall clock is one of
the machine's, under the latest command that has come by then; drives send their feedback whether or
not they are spoken to, as real ones do.
"""

import itertools
import os
import time
from collections.abc import Mapping, Sequence
from typing import Any

import can
import numpy as np

from spirob.can_protocol import (
    COMMAND_ID,
    FEEDBACK_ID,
    VOLTAGE_FEEDBACK_ID,
    VOLTAGE_ID,
    CanFrame,
    Feedback,
    decode_command,
    decode_volts,
    encode_command,
    encode_feedback,
)
from spirob.emulator.faults import Wire, wire_from
from spirob.emulator.machine import Machine
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.errors import HardwareError
from spirob.robot import CYCLE_NS, MOTORS, Scene

SECOND_NS = 1e9
HOLD_CYCLES = 100  # that a drive goes on with its last current
HOLD_VOLTAGE = 10  # and with its last voltage, which does not know what current it drives
IDLE = encode_command((0.0,) * len(MOTORS))


class Message(can.Message):
    """A message that python-can copies for each receiver at a third of the cost."""

    def __deepcopy__(self, memo: dict[int, Any] | None) -> "Message":
        return Message(
            timestamp=self.timestamp,
            arbitration_id=self.arbitration_id,
            is_extended_id=self.is_extended_id,
            data=bytes(self.data),
        )


class DriveNode:
    """Two drives that share one command frame.

    now_ns  simulated time since the trial began
    command_id, feedback_id  what it listens to, and before what it says
    wire    what goes wrong inside the drives
    """

    def __init__(self, bus: can.BusABC, machine: Machine, wire: Wire | None = None):
        self.machine = machine
        self._bus = bus
        self._wire = wire or Wire()
        self._volts = float(machine.numbers["supply"][0])
        by_voltage = machine.rig.by_voltage
        self.command_id = VOLTAGE_ID if by_voltage else COMMAND_ID
        self.feedback_id = VOLTAGE_FEEDBACK_ID if by_voltage else FEEDBACK_ID
        self._wire.feedback_id = self.feedback_id
        self._decode = decode_volts if by_voltage else decode_command
        self._hold = HOLD_VOLTAGE if by_voltage else HOLD_CYCLES
        self.begin()

    def begin(self) -> None:
        """A new trial at time zero, without any command yet."""
        self.now_ns = self._idle = 0
        self._command = IDLE

    def cycle(self, silent: bool = False) -> None:
        """One millisecond under the latest command that is waiting, or else under the last.

        silent  nothing is told of it
        """
        self._idle += 1
        while (message := self._bus.recv(timeout=0)) is not None:
            if message.arbitration_id == self.command_id and not message.is_extended_id:
                self._command, self._idle = bytes(message.data), 0
        if self._idle > self._hold:
            self._command = IDLE
        if self._wire:
            self.machine.numbers["supply"] = self._wire.supply(self._volts)
        counts = self.machine.cycle(self._decode(self._command, len(MOTORS)))
        self.now_ns += CYCLE_NS
        if not silent:
            self._tell(counts)

    def _tell(self, counts: np.ndarray) -> None:
        for drive, (angle, speed, current, temperature) in enumerate(counts.tolist(), start=1):
            feedback = Feedback(angle, speed, current, temperature)
            if self._wire:
                feedback = self._wire.sensed(drive - 1, feedback)
            self._bus.send(
                Message(
                    timestamp=self.now_ns / SECOND_NS,
                    arbitration_id=self.feedback_id + drive,
                    is_extended_id=False,
                    data=encode_feedback(feedback),
                )
            )


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
    return Message(
        timestamp=frame.stamp_ns / SECOND_NS,
        arbitration_id=frame.arbitration_id,
        is_extended_id=False,
        data=frame.data,
    )


def _virtual_bus(channel: str) -> can.BusABC:
    return can.Bus(interface="virtual", channel=channel, preserve_timestamps=True)


MOST = 1000  # cycles lived through at once
NAP_NS = 200_000  # before the deadline, where sleeping is not exact any more


def serve(bus: can.BusABC, machine: Machine, seconds: float) -> int:
    """Run for some seconds of the wall clock; returns in how many cycles nobody was told anything.

    Where the computer is late, the machine still lives through the time: its drives only fail to
    speak.
    """
    wire = Wire()
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
