"""Two drives on a virtual bus: each answers at its own millisecond, in a thread of its own."""

from spirob.can_protocol import COMMAND_ID, FEEDBACK_ID, Feedback, decode_command, encode_feedback
from spirob.robot import MOTORS
from tests.can.served import Served


class FakeDrives(Served):
    """Answers every command; `mute` names the motors that do not. Keeps all commands."""

    def __init__(self, channel, mute=()):
        super().__init__(channel)
        self.mute, self.commands, self.angle = set(mute), [], 0

    def answer(self, message):
        if message.arbitration_id != COMMAND_ID:
            return
        currents = decode_command(bytes(message.data))
        self.commands.append(currents)
        self.angle = (self.angle + 5) % 8192
        for m, motor in enumerate(MOTORS):
            if motor not in self.mute:
                said = Feedback(self.angle, 10, round(currents[m] * 100), 30)
                self.say(FEEDBACK_ID + 1 + m, encode_feedback(said))
