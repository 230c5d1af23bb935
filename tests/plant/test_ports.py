"""What passes a port arrives: with the right step, the right memory and the right physics."""

import mujoco
import numpy as np
import pytest

from spirob.control import CURRENT, VELOCITY, Schedule
from spirob.effects import all_effects
from spirob.geometry import spiral_arm
from spirob.plant import Plant, Rig
from spirob.plant.body import build_spec, hinge_weights
from spirob.plant.rig import Arm
from spirob.robot import Scene

LIBRARY = all_effects()
CYCLES = 600


@pytest.fixture(scope="module")
def plant():
    return Plant(Rig(), list(LIBRARY.values()))


def strokes(cycles=CYCLES, size=0.12):
    speed = size * np.sin(2 * np.pi * np.arange(cycles) * 1e-3 / 0.3)
    return schedule(VELOCITY, speed, -speed)


def squeeze(cycles=CYCLES):
    pull = 1.0 + 0.3 * np.sin(2 * np.pi * np.arange(cycles) * 1e-3 / 0.4)
    return schedule(CURRENT, pull, np.full(cycles, 0.6))


def schedule(mode, left, right):
    reference = np.column_stack([left, right])
    return Schedule(np.array([mode, mode]), reference, np.zeros_like(reference), np.full(2, 5.0))


def split(whole, at):
    parts = (slice(None, at), slice(at, None))
    return [
        Schedule(whole.mode, whole.reference[p], whole.reference_rate[p], whole.current_limit)
        for p in parts
    ]


def nominal(name, **numbers):
    values = {n: about.nominal for n, about in LIBRARY[name].parameters().items()} | numbers
    return {f"{name}.{n}": v for n, v in values.items()}


@pytest.mark.parametrize("name", [n for n, e in LIBRARY.items() if e.state])
def test_a_trial_in_two_pieces_remembers_as_one(plant, name):
    # the reading after the last cycle of a piece is that before the first of the next
    changes = nominal(name)
    one = plant.start(Scene(), changes).play(strokes())
    session = plant.start(Scene(), changes)
    first, second = (session.play(part) for part in split(strokes(), 251))
    for column in ("current", "displacement", "velocity", "tension"):
        pieces = np.concatenate([getattr(first, column)[:-1], getattr(second, column)])
        np.testing.assert_array_equal(pieces, getattr(one, column))


@pytest.mark.parametrize("latency", [0.001, 0.0025, 0.008])
def test_latency_delays_every_reading_alike(plant, latency):
    # the current is commanded, so the motion does not depend on the feedback
    prompt = plant.simulate(squeeze(), Scene())
    late = plant.simulate(squeeze(), Scene(), nominal("feedback_latency", latency=latency))
    time = np.arange(CYCLES) * 1e-3
    for column in ("current", "displacement", "arm_current"):
        for m in range(2):
            want = np.interp(time - latency, time, getattr(prompt, column)[:, m])
            got = getattr(late, column)[:, m]
            np.testing.assert_allclose(got[10:], want[10:], rtol=1e-9, atol=1e-9)
    rate = np.diff(late.displacement[:, 0]) / 1e-3
    np.testing.assert_allclose(late.velocity[11:, 0], rate[10:], atol=5e-3)


@pytest.mark.parametrize(
    ("wrong", "carried"),
    [
        ({"current_offset.offset": 0.05}, (1.0, -0.05)),
        ({"current_gain.gain_error": 0.1}, (1 / 1.1, 0.0)),
    ],
)
def test_a_drive_regulates_what_its_sensor_reads(plant, wrong, carried):
    # the reading follows the command; the arm moves as with the current that the winding carries
    misread = plant.simulate(squeeze(), Scene(), wrong)
    factor, added = carried
    told = squeeze()
    winding = schedule(CURRENT, *(told.reference.T * factor + added))
    plain = plant.simulate(winding, Scene())
    np.testing.assert_allclose(misread.current[21:], told.reference[20:-1], atol=1e-3)
    np.testing.assert_allclose(misread.displacement, plain.displacement, atol=5e-5)
    np.testing.assert_allclose(misread.tension[100:], plain.tension[100:], rtol=5e-3)
    unaware = plant.simulate(told, Scene())
    assert unaware.tension[100:].mean() > 1.03 * misread.tension[100:].mean()


def test_a_wrong_gain_stands_for_another_efficiency(plant):
    gain, factor = LIBRARY["current_gain"], 1.1
    mixed = schedule(CURRENT, squeeze().reference[:, 0], np.full(CYCLES, 0.6))
    mixed.mode[0] = VELOCITY
    mixed.reference[:, 0] = strokes().reference[:, 0]
    wrong = plant.simulate(mixed, Scene(), {"current_gain.gain_error": factor - 1.0})
    plain = plant.simulate(mixed, Scene())
    for number in gain.stands_for:
        weaker = {number: plant.table.about[number].nominal / factor}
        same = plant.simulate(mixed, Scene(), weaker)
        moved = np.abs(plain.current - same.current)[50:].max()
        assert moved > 0.02
        assert np.abs(wrong.current - same.current)[50:].max() < 0.03 * moved


def test_what_an_effect_stands_for_is_a_number_of_the_model(plant):
    for effect in LIBRARY.values():
        assert set(effect.stands_for) <= set(plant.table.names)


def test_the_left_rotor_is_heavier_by_half_the_difference(plant):
    """Each motor alone is one whose inertia is that of its side; i** knows it, too."""
    mean = plant.table.about["motor.rotor_inertia"].nominal
    differ = plant.simulate(strokes(), Scene(), {"motor.rotor_inertia_difference": 0.1})
    for side, share in enumerate((1.1, 0.9)):
        alike = plant.simulate(strokes(), Scene(), {"motor.rotor_inertia": share * mean})
        plain = plant.simulate(strokes(), Scene())
        for column in ("current", "arm_current"):
            got, want, unaware = (getattr(r, column)[5:20, side] for r in (differ, alike, plain))
            assert np.abs(got - want).max() < 0.1 * np.abs(unaware - want).max()


def test_what_the_firmware_does_to_the_report_stays_out_of_the_loop(plant):
    prompt = plant.simulate(squeeze(), Scene())
    late = plant.simulate(squeeze(), Scene(), nominal("current_lag", time=0.05))
    np.testing.assert_array_equal(late.tension, prompt.tension)
    assert np.abs(late.current - prompt.current).max() > 0.1


def test_smoothing_is_that_of_the_cycle_not_of_the_step(plant):
    prompt = plant.simulate(squeeze(), Scene())
    late = plant.simulate(squeeze(), Scene(), nominal("current_lag", time=0.01))
    want, filtered = [], 0.0
    for value in prompt.current[:, 0]:
        filtered = value + (filtered - value) * np.exp(-1e-3 / 0.01)
        want.append(filtered)
    np.testing.assert_allclose(late.current[:, 0], want, rtol=1e-12)


def test_the_arm_current_is_smoothed_with_a_memory_of_its_own(plant):
    prompt = plant.simulate(squeeze(), Scene())
    late = plant.simulate(squeeze(), Scene(), nominal("current_lag", time=0.01))
    want, filtered = [], 0.0
    for value in prompt.arm_current[:, 1]:
        filtered = value + (filtered - value) * np.exp(-1e-3 / 0.01)
        want.append(filtered)
    np.testing.assert_allclose(late.arm_current[:, 1], want, rtol=1e-9, atol=1e-12)


def test_the_velocity_read_is_the_rate_of_the_length_read(plant):
    changes = nominal("encoder_eccentricity", sine=1e-4)
    read = plant.simulate(strokes(), Scene(), changes)
    rate = np.diff(read.displacement[:, 0]) / 1e-3
    assert np.abs(read.velocity[1:, 0] - rate).max() < 0.02 * np.abs(rate).max()
    plain = plant.simulate(strokes(), Scene())
    assert np.abs(read.velocity - plain.velocity).max() > 2e-3


def test_a_compliant_gear_is_a_softer_tendon(plant):
    stiffness = Rig().tendon.stiffness
    soft = stiffness / (1 + stiffness * 2.5e-5)
    damping = Rig().tendon.damping * soft / stiffness
    gear = plant.simulate(squeeze(), Scene(), nominal("gear_compliance", compliance=2.5e-5))
    changes = {"tendon.stiffness": soft, "tendon.damping": damping}
    tendon = plant.simulate(squeeze(), Scene(), changes)
    np.testing.assert_allclose(gear.tension, tendon.tension, rtol=1e-6, atol=1e-6)


def test_the_toe_gives_way_as_its_law_says(plant):
    toe, k = 1e-3, Rig().tendon.stiffness
    hold = schedule(CURRENT, *np.array([[0.9], [0.6]]) * np.ones(3000))
    held = plant.simulate(hold, Scene(), nominal("stretch", toe=toe))
    stretch = (held.displacement - held.shortening)[-1]
    assert (stretch > 0.5 * toe).all()
    law = k * (stretch - toe * (1 - np.exp(-stretch / toe)))
    np.testing.assert_allclose(held.tension[-1], law, rtol=0.01)


def test_play_is_not_seen_while_the_tendon_stays_taut(plant):
    taut = schedule(CURRENT, *np.full((2, CYCLES), 0.8))
    plain = plant.simulate(taut, Scene())
    assert plain.tension[5:].min() > 0.0
    loose = plant.simulate(taut, Scene(), nominal("backlash", rest=0.0))
    assert np.abs(plain.displacement - loose.displacement).max() < 1e-4 * 1e-3
    slack = plant.simulate(strokes(), Scene())
    assert slack.tension[5:].min() == 0.0
    loose = plant.simulate(strokes(), Scene(), nominal("backlash", rest=0.0))
    assert np.abs(slack.displacement - loose.displacement).max() > 1e-4


@pytest.mark.parametrize(("roll", "pitch"), [(0.3, 0.0), (0.0, 0.4), (-0.2, 0.1)])
def test_a_tilted_mount_is_gravity_in_the_plane(plant, roll, pitch):
    tilt = plant.simulate(strokes(), Scene(), nominal("mount_tilt", roll=roll, pitch=pitch))
    changes = {"arm.gravity_x": 9.80665 * np.sin(pitch), "arm.gravity_y": 9.80665 * np.sin(roll)}
    gravity = plant.simulate(strokes(), Scene(), changes)
    np.testing.assert_allclose(tilt.angles, gravity.angles, atol=1e-6)
    assert np.abs(tilt.angles - plant.simulate(strokes(), Scene()).angles).max() > 1e-3


def test_the_weight_at_each_hinge_is_that_of_the_body():
    arm, mass = Arm(gravity_x=0.0, gravity_y=9.80665), 0.05
    geometry = spiral_arm(24)
    model = build_spec(arm, Scene(), spiral_arm(24), 5e-4, tip_mass=mass).compile()
    data = mujoco.MjData(model)
    data.qpos[:] = np.random.default_rng(3).uniform(-0.4, 0.4, 24)
    mujoco.mj_forward(model, data)
    units = np.column_stack(
        [np.append(model.body_mass[1:25], mass), np.append(geometry.unit_length, 0.0)]
    )
    weight = np.zeros((24, 2))
    hinge_weights(data.qpos, units, weight)
    np.testing.assert_allclose(weight[:, 1], -data.qfrc_bias, rtol=1e-9, atol=1e-12)


def test_a_payload_weighs_what_it_should(plant):
    # held in a level plane it loads nothing; with gravity across, its whole lever
    arm = Arm(gravity_y=9.80665)
    bare, loaded = (
        build_spec(arm, Scene(), spiral_arm(24), 5e-4, tip_mass=m).compile() for m in (0.0, 0.05)
    )
    torques = []
    for model in (bare, loaded):
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        torques.append(-data.qfrc_bias[0])
    lever = spiral_arm(24).unit_length.sum()
    assert torques[1] - torques[0] == pytest.approx(0.05 * 9.80665 * lever, rel=1e-9)


def test_a_smooth_sign_scales_with_the_rig(plant):
    # what friction adds to a crawl: all of it where the crawl is motion, little where it is rest
    crawl = strokes(size=0.004)
    friction = nominal("coulomb_friction", coulomb_torque=0.002)
    plain = plant.simulate(crawl, Scene())
    soft, steep = (
        plant.simulate(crawl, Scene(), {**friction, "motor.rest_speed": speed})
        for speed in (20.0, 0.2)
    )
    added = [np.abs(r.current - plain.current)[150:].mean() for r in (soft, steep)]
    assert added[1] > 2.0 * added[0]
