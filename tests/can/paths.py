"""Every way a command can go, each with all commands that reached its drives."""

from contextlib import contextmanager

from spirob.can.bus import open_bus
from spirob.can.robot import CanRobot
from spirob.can_protocol import COMMAND_ID, FEEDBACK_ID, Feedback, decode_command, encode_feedback
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.robot import Scene
from tests.can.served import Served
from tests.trials.fake_robot import FakeRobot


class Answers(Served):
    """Drives that stand still whatever they are told."""

    def answer(self, message):
        if message.arbitration_id == COMMAND_ID:
            for m in (1, 2):
                self.say(FEEDBACK_ID + m, encode_feedback(Feedback(0, 0, 0, 25)))


def commands_of(bus):
    """All commands that a bus was given, as they are given: no thread has to take them in first."""
    commands, send = [], bus.send

    def noted(message, timeout=None):
        send(message, timeout)
        if message.arbitration_id == COMMAND_ID:
            commands.append(decode_command(bytes(message.data)))

    bus.send = noted
    return commands


@contextmanager
def can_path():
    channel = f"safety-{id(object())}"
    bus = open_bus("virtual", channel)
    commands = commands_of(bus)
    with Answers(channel):
        robot = CanRobot(bus, silence_ns=500_000_000, ask=lambda question: "arm")
        try:
            robot.prepare(Scene())
            yield robot, commands
        finally:
            robot.close()


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
