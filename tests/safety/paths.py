"""Every way a command can go, each with all commands that reached its drives."""

import threading
from contextlib import contextmanager

import can

from spirob.can_protocol import COMMAND_ID, FEEDBACK_ID, Feedback, decode_command, encode_feedback
from spirob.canbus import CanRobot, open_bus
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.robot import Scene
from tests.bench.fake_robot import FakeRobot


class Answers:
    """Drives on a virtual bus that answer every command, in a thread of their own."""

    def __init__(self, channel):
        self.bus = can.Bus(interface="virtual", channel=channel)
        self.commands = []
        self.stop = threading.Event()
        self.thread = threading.Thread(target=self._serve, daemon=True)
        self.thread.start()

    def _serve(self):
        while not self.stop.is_set():
            message = self.bus.recv(0.01)
            if message is None or message.arbitration_id != COMMAND_ID:
                continue
            self.commands.append(decode_command(bytes(message.data)))
            for m in (1, 2):
                data = encode_feedback(Feedback(0, 0, 0, 25))
                self.bus.send(
                    can.Message(arbitration_id=FEEDBACK_ID + m, data=data, is_extended_id=False)
                )


@contextmanager
def can_path():
    channel = f"safety-{id(object())}"
    drives = Answers(channel)
    robot = CanRobot(
        open_bus("virtual", channel), silence_ns=500_000_000, ask=lambda question: "arm"
    )
    try:
        robot.prepare(Scene())
        yield robot, drives.commands
    finally:
        robot.close()
        drives.stop.set()
        drives.thread.join()
        drives.bus.shutdown()


@contextmanager
def fake_path():
    robot = FakeRobot()
    yield robot, robot.commands


@contextmanager
def emulated_path():
    robot = EmulatedRobot(EmulatedRig(), HiddenSettings("none"), seed=3)
    commands = []
    cycle = robot.machine.cycle

    def seen(currents):
        commands.append(currents)
        return cycle(currents)

    robot.machine.cycle = seen
    robot.prepare(Scene())
    yield robot, commands
    robot.close()


PATHS = {"fake": fake_path, "emulated": emulated_path, "can": can_path}
