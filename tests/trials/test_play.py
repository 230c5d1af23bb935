"""Playing follows the trial, and ends at zero current however it ends."""

import numpy as np
import pytest

from spirob.can_protocol import AMPERE_PER_COUNT
from spirob.errors import HardwareError
from spirob.logs import read_log
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import plain_trial, record_on


def test_a_trial_is_played_to_its_last_cycle_and_ends_at_zero(tmp_path):
    robot = FakeRobot()
    path = record_on(robot, tmp_path, 0.4)
    assert path == tmp_path / "trial.mcap"
    assert len(robot.commands) == 1 + 400 + 1  # first feedback, the trial, the last zero
    assert robot.commands[0] == robot.commands[-1] == (0.0, 0.0)
    assert robot.scene.cylinder.diameter == 0.04
    assert sorted(p.name for p in tmp_path.iterdir()) == ["trial.mcap"]


def test_velocity_is_followed(tmp_path):
    motors = plain_trial()["motors"]
    motors["left"]["profile"] = {"kind": "constant", "value": 0.05}
    trace = read_log(record_on(FakeRobot(), tmp_path, 1.5, motors=motors))
    assert np.abs(trace["left.velocity"][-200:] - 0.05).max() < 0.002
    assert trace["left.displacement"][-1] == pytest.approx(0.075, abs=0.02)


@pytest.mark.parametrize("error", [HardwareError("gone"), KeyboardInterrupt(), ZeroDivisionError()])
@pytest.mark.parametrize("fail_at", [1, 2, 200])
def test_after_any_exception_the_last_command_is_zero(tmp_path, error, fail_at):
    robot = FakeRobot(fail_at, error)
    with pytest.raises(type(error)):
        record_on(robot, tmp_path, 0.4)
    assert robot.commands[-1] == (0.0, 0.0)
    assert len(robot.commands) == fail_at + 1
    assert not (tmp_path / "trial.mcap").exists()


def test_what_stood_under_the_name_survives_a_failed_trial(tmp_path):
    before = record_on(FakeRobot(), tmp_path).read_bytes()
    with pytest.raises(HardwareError):
        record_on(FakeRobot(200, HardwareError("gone")), tmp_path)
    assert (tmp_path / "trial.mcap").read_bytes() == before


def test_the_part_before_a_fault_can_be_read(tmp_path):
    with pytest.raises(HardwareError):
        record_on(FakeRobot(200, HardwareError("gone")), tmp_path)
    assert len(read_log(tmp_path / "trial.mcap.part")) == 198


def test_the_current_stays_within_its_limit(tmp_path):
    motors = plain_trial()["motors"]
    motors["left"]["current_limit"] = 0.25
    robot = FakeRobot()
    record_on(robot, tmp_path, motors=motors)
    assert max(abs(left) for left, _ in robot.commands) <= 0.25 + AMPERE_PER_COUNT / 2


def test_a_drive_that_never_answers_is_named(tmp_path):
    class Mute(FakeRobot):
        def exchange(self, command):
            return super().exchange(command)[:2]

    with pytest.raises(HardwareError, match="motor right"):
        record_on(Mute(), tmp_path)


def test_a_late_first_answer_is_waited_for(tmp_path):
    class Late(FakeRobot):
        def exchange(self, command):
            frames = super().exchange(command)
            return frames if len(self.commands) > 5 else frames[:1]

    trace = read_log(record_on(Late(), tmp_path))
    assert len(trace) == 400
    assert trace["left.displacement"][0] == 0.0
