"""The model's loop on the host reads frames: noise, current in counts, speed in whole rpm."""

from dataclasses import fields

import numpy as np
import pytest

from spirob.can.drive import find_drive
from spirob.can_protocol import AMPERE_PER_COUNT, VOLT_PER_COUNT
from spirob.control import HostLoop, host_voltage
from spirob.logs import Transmission
from spirob.plant import Frames, Plant, Rig
from spirob.plant.motor import counted
from spirob.robot import Scene
from spirob.trials import Trial
from spirob.trials.simulation import FRAMES, simulate
from tests.physics.playing import DIRECT, currents
from tests.trials.trials import plain_trial

NOISE = 0.005  # A
HOST = Rig(winch=DIRECT.winch, gains=DIRECT.gains, host=HostLoop(bandwidth=20.0))


def asked(cycles=300):
    t = np.arange(cycles) * 1e-3
    return currents(0.6 + 0.3 * np.sin(20 * t), 0.4)


def noise_of(schedule, seed=1):
    return np.random.default_rng(seed).normal(0.0, NOISE, schedule.reference.shape)


def steps(seconds=0.3):
    profile = {"kind": "constant", "value": 0.5, "blend": 0.05}
    held = {"mode": "current", "current_limit": 5.0, "profile": profile}
    motors = {"left": held, "right": held}
    return Trial.from_plain(plain_trial(duration=seconds, motors=motors, scene={}))


def same(one, other):
    names = [f.name for f in fields(one)]
    return all(np.array_equal(getattr(one, n), getattr(other, n)) for n in names)


def test_counts_are_those_of_the_drives_frames():
    codec = find_drive("gm6020").codec
    message = codec.message("FEEDBACK_1")
    one = {s.name: float(s.scale) for s in message.signals}
    assert codec.unit("FEEDBACK_1", "speed") == "rpm"
    assert FRAMES.current == one["current"] == AMPERE_PER_COUNT
    assert pytest.approx(2 * np.pi / 60 * one["speed"], rel=1e-12) == FRAMES.speed
    rig = Transmission(gear_ratio=3.0, winch_radius=0.02)
    speed = FRAMES.speed * rig.winch_radius / rig.gear_ratio
    assert speed == pytest.approx(rig.metre_per_second_per_rpm, rel=1e-12)


@pytest.mark.parametrize(("value", "count", "read"), [(7.4, 2.0, 8.0), (-3.1, 2.0, -4.0)])
def test_a_count_is_the_nearest_and_none_is_all_of_it(value, count, read):
    assert counted(value, count) == read
    assert counted(value, 0.0) == value


def test_without_counts_and_noise_every_bit_is_as_it_was():
    plain, schedule = Plant(HOST), asked()
    none = np.zeros_like(schedule.reference)
    exact = plain.simulate(schedule, Scene())
    assert same(exact, plain.reading(Frames()).simulate(schedule, Scene(), noise=none))
    read = plain.reading(FRAMES)
    assert not same(exact, read.simulate(schedule, Scene(), noise=none))
    assert not plain.settings["host_current_count"].any()  # a machine of its own
    assert same(exact, read.reading(Frames()).simulate(schedule, Scene()))


def test_a_loop_in_the_drive_reads_no_frames():
    plain, schedule = Plant(DIRECT), asked()
    noisy = plain.reading(FRAMES).simulate(schedule, Scene(), noise=noise_of(schedule))
    assert same(plain.simulate(schedule, Scene()), noisy)


def test_a_drives_loop_has_the_noise_on_its_report_alone():
    plant, trial = Plant(DIRECT), steps()
    exact = plant.simulate(trial.schedule(), trial.scene)
    draws = np.random.default_rng(4).normal(0.0, 1.0, (3, *exact.current.shape)) * NOISE
    counts = np.round((exact.current + draws) / AMPERE_PER_COUNT) * AMPERE_PER_COUNT
    told = simulate(plant, trial, {}, NOISE, 4, shots=3)
    assert np.array_equal(told["left.current"], counts.mean(axis=0)[:, 0])
    assert np.array_equal(told["left.velocity"], exact.velocity[:, 0])


def test_every_voltage_follows_from_whole_counts():
    plant, schedule = Plant(HOST).reading(FRAMES), asked()
    played = plant.simulate(schedule, Scene(), noise=noise_of(schedule))
    counts = played.current / FRAMES.current
    assert counts == pytest.approx(np.rint(counts), abs=1e-9)
    motor, gains = HOST.motor, HOST.placed().gains
    for m in range(2):
        integral, error, before = 0.0, None, 0.0
        for k in range(schedule.cycles):
            command, current = played.command[k, m], played.current[k, m]
            error = command - current if error is None else error
            rpm = np.rint(played.velocity[k, m] / HOST.winch.radius / FRAMES.speed)
            volts, integral, error = host_voltage(
                command,
                before,
                current,
                error,
                rpm * FRAMES.speed,
                integral,
                1e-3,
                motor.resistance,
                motor.inductance,
                motor.emf_constant,
                *gains,
                HOST.drive.voltage_limit,
            )
            before = command
            assert played.voltage[k, m] == pytest.approx(volts, abs=0.5001 * VOLT_PER_COUNT)


def test_noise_is_drawn_for_every_shot_from_the_seed():
    plant, trial = Plant(HOST), steps()
    one, again, other = (simulate(plant, trial, {}, NOISE, seed) for seed in (3, 3, 4))
    assert np.array_equal(one["left.current"], again["left.current"])
    assert not np.array_equal(one["left.voltage"], other["left.voltage"])
    draws = np.random.default_rng(3).normal(0.0, 1.0, (4, trial.cycles, 2)) * NOISE
    read = plant.reading(FRAMES)
    shots = [read.simulate(trial.schedule(), trial.scene, noise=d) for d in draws]
    mean = simulate(plant, trial, {}, NOISE, 3, shots=4)
    for name in ("current", "velocity", "voltage"):
        each = np.array([getattr(shot, name)[:, 0] for shot in shots])
        assert mean[f"left.{name}"] == pytest.approx(each.mean(axis=0), abs=1e-12)
        assert np.ptp(each, axis=0).max() > 0.0


def test_the_mean_over_shots_comes_to_what_exact_readings_give():
    plant, trial, shots = Plant(HOST), steps(0.4), 60
    exact = simulate(plant, trial, {})
    late = slice(150, None)
    apart = {}
    for n in (1, shots):
        found = simulate(plant, trial, {}, NOISE, 5, shots=n)
        apart[n] = found["left.current"][late] - exact["left.current"][late]
    # noise, and what the loop makes of it; counts of the exact loop's own voltage stay
    assert apart[1].std() > NOISE
    assert apart[shots].std() < 3.5 * apart[1].std() / np.sqrt(shots)
    assert abs(apart[shots].mean()) < AMPERE_PER_COUNT / 2


def test_without_noise_the_loop_reads_exact_values():
    plant, trial = Plant(HOST), steps()
    told = simulate(plant, trial, {})
    exact = plant.simulate(trial.schedule(), trial.scene)
    assert np.array_equal(told["left.voltage"], exact.voltage[:, 0])
