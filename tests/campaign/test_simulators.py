"""Each simulator keeps the laws of mechanics, whatever is hidden in it."""

import mujoco
import numpy as np
import pytest

from spirob.campaign.case import KINDS
from spirob.campaign.recorder import reported
from spirob.campaign.simulators import SIMULATORS, arm, bench, rigid, two_mass
from spirob.campaign.simulators.hidden import Hidden, Scale, hiding, memory
from spirob.campaign.simulators.motion import FINE, Machine, Plan, plan

AXIS = rigid.Rigid(0.02, 0.05, 0.003, 2, 4.0, 0.4, 0.0)
MASSES = two_mass.TwoMass(
    0.01, 0.01, 0.05, 0.05, 1.0, 1e-3, 0.5, 200.0, 4.0, 0.4, 0.02, False, False
)
LINKS = arm.Arm(
    *(
        1.2,
        0.8,
        0.4,
        0.3,
        0.2,
        0.15,
        0.016,
        0.006,
        9.81,
        0.02,
        0.05,
        0.05,
        0,
        90.0,
        6.0,
        400.0,
        12.0,
        False,
    )
)
NOTHING = Hidden()


def machine(numbers, inertia=0.02, viscous=0.05):
    return Machine("any", True, inertia, viscous, "torque", 1.0, "measured", numbers, 2.0, 1.0)


def tones(seconds=4.0, seed=0):
    return plan("tones", np.random.default_rng(seed), seconds, 2.0, 1.0)


def asked_beside(motion, inertia, viscous):
    """What an axis asks for beside its inertia and viscous friction."""
    a = np.gradient(motion.v, 1 / FINE)
    return (motion.effort - inertia * a - viscous * motion.v)[50:-50]


WHOLE = [
    (SIMULATORS["rigid"], machine(AXIS)),
    (SIMULATORS["two_mass"], machine(MASSES)),
    (SIMULATORS["bench"], machine(bench.Bench(0.02, 0.05))),
    (SIMULATORS["arm"], machine(LINKS._replace(gravity=0.0, m1=0.0, m2=0.0, i1=0.0, i2=0.0))),
]
LAWS = [
    (Hidden(drag=0.01), lambda q, v: 0.01 * v * np.abs(v)),
    (Hidden(weight=0.3, hangs=0.2), lambda q, v: 0.3 * np.sin(q - 0.2)),
    (Hidden(asymmetric=0.04), lambda q, v: 0.02 * np.abs(v)),
    (Hidden(force=0.1), lambda q, v: np.full_like(q, -0.1)),
    (Hidden(cubic=0.2, middle=0.1, half=0.5), lambda q, v: 0.2 * ((q - 0.1) / 0.5) ** 3),
]


@pytest.mark.parametrize(("simulator", "axis"), WHOLE, ids=[s.name for s, _ in WHOLE])
@pytest.mark.parametrize(("hidden", "law"), LAWS, ids=["drag", "weight", "ways", "force", "cubic"])
def test_the_effort_holds_the_hidden_law(simulator, axis, hidden, law):
    motion = simulator.play(axis, hidden, tones())
    wanted = law(motion.q, motion.v)[50:-50]
    own = {"rigid": 0.02, "two_mass": 0.02, "bench": 0.02, "arm": LINKS.rotor}[simulator.name]
    found = asked_beside(motion, own, 0.05)
    slow = np.ones(250) / 250  # the load swings on its shaft, the controller holds
    left = np.convolve(found - wanted, slow, "valid")
    assert np.sqrt(np.mean(left**2)) < 0.05 * np.sqrt(np.mean(wanted**2))


@pytest.mark.parametrize("driven", [0, 1])
def test_beside_a_clamped_joint_an_arm_is_one_inertia(driven):
    """Held by a controller the other link swings, and passes for an elastic shaft."""
    bare = LINKS._replace(gravity=0.0, driven=driven, locked=True)
    motion = SIMULATORS["arm"].play(machine(bare), NOTHING, tones())
    fore = bare.i2 + bare.m2 * (bare.c2 + (bare.l1 if driven == 0 else 0.0)) ** 2
    inertia = fore + (bare.i1 + bare.m1 * bare.c1**2 if driven == 0 else 0.0) + bare.rotor
    left = asked_beside(motion, inertia, bare.viscous)
    assert np.sqrt(np.mean(left**2)) < 5e-3 * np.sqrt(np.mean(motion.effort**2))
    swinging = SIMULATORS["arm"].play(machine(bare._replace(locked=False)), NOTHING, tones())
    assert np.std(asked_beside(swinging, inertia, bare.viscous)) > 5 * np.std(left)


@pytest.mark.parametrize(("simulator", "axis"), WHOLE[:2], ids=["rigid", "two_mass"])
def test_the_motor_pays_for_what_moves_and_what_rubs(simulator, axis):
    hidden = Hidden(level=0.2, drag=0.01)
    motion = simulator.play(axis, hidden, tones())
    work = np.sum(motion.effort * motion.v) / FINE
    moving = 0.5 * 0.02 * (motion.v[-1] ** 2 - motion.v[0] ** 2)
    lost = np.sum(0.05 * motion.v**2 + 0.2 * np.abs(motion.v) + 0.01 * np.abs(motion.v) ** 3) / FINE
    assert work == pytest.approx(moving + lost, rel=0.03)


def path(seconds, rate, columns):
    t = np.arange(round(seconds * rate)) / rate
    wanted = 0.5 * np.sin(2 * np.pi * t) ** 2
    speed = 0.5 * 2 * np.pi * np.sin(4 * np.pi * t)
    still = np.zeros_like(t)
    return np.column_stack([wanted, speed] if columns == 2 else [wanted, still, speed, still])


@pytest.mark.parametrize("name", ["rigid", "arm"])
def test_half_the_step_is_half_the_error(name):
    hidden = Hidden(level=0.05, drag=0.01, way=0.1)

    def end(rate):
        if name == "rigid":
            p = AXIS._replace(hold=1)
            wanted = path(1.0, rate, 2)
            nothing = np.zeros(len(wanted))
            out = rigid._played(wanted, nothing, p, hidden, memory(), 0.0, 1 / rate)
            return out[0][:: rate // 1000]
        out = arm._played(path(1.0, rate, 4), LINKS, hidden, memory(), 0.0, 1 / rate)
        return out[0][0][:: rate // 1000]

    exact = end(64000)
    errors = [np.max(np.abs(end(rate) - exact)) for rate in (2000, 4000, 8000)]
    assert errors[0] > 1.6 * errors[1] > 1.6**2 * errors[2]


def test_runge_and_kutta_are_of_fourth_order():
    hidden = Hidden(drag=0.01, soft=1 / 60.0**2)
    start = np.array([0.0, 1.0, 0.0, 0.5, 0.1, 0.0])

    def end(steps):
        x = start
        for _ in range(steps):
            x = two_mass.step(x, 1.0, 0.01 / steps, 3.0, 0.05, 0.0, memory(), MASSES, hidden)
        return x

    exact = end(2000)
    coarse, fine = (np.max(np.abs(end(n) - exact)) for n in (25, 50))
    assert 12.0 < coarse / fine < 20.0


def test_flanks_pass_momentum_and_never_give_energy():
    hidden = Hidden(play=0.1, soft=1 / 40.0**2)
    p = MASSES._replace(constant=1e-9)
    x, dt = np.array([0.0, 2.0, 0.0, 0.0, 0.0, 0.0]), 5e-5
    stiffness, _ = two_mass.spring(p, hidden)
    energies, met = [], set()
    for k in range(20000):
        side = two_mass.touching(x, hidden)
        met.add(side)
        bend = x[0] - x[2] - side * 0.05
        stored = 0.5 * stiffness * bend**2 * abs(side)
        energies.append(0.5 * (p.motor * x[1] ** 2 + p.load * x[3] ** 2) + stored)
        x = two_mass.advance(x, dt, 0.0, 0.0, k * dt, memory(), p, hidden)
    assert met == {-1.0, 0.0, 1.0}
    assert p.motor * x[1] + p.load * x[3] == pytest.approx(p.motor * 2.0, rel=1e-6)
    assert np.max(np.diff(energies)) < 1e-6 * energies[0]
    assert energies[-1] < 0.8 * energies[0]


def test_the_drive_is_bounded_by_its_supply():
    hidden = Hidden()
    weak = MASSES._replace(supply=1.0)
    motion = two_mass.play(machine(weak._replace(volts=True)), hidden, tones())
    assert np.max(np.abs(motion.effort)) == pytest.approx(1.0)


FREE = LINKS._replace(stiff=0, damped=0, other_stiff=0, other_damped=0, viscous=0, held=0, rotor=0)


def test_links_that_swing_freely_keep_their_energy():
    def drift(rate):
        wanted = np.tile([1.0, 0.5, 0.0, 0.0], (2 * rate, 1))
        q, v, _ = arm._played(wanted, FREE, NOTHING, memory(), 0.0, 1 / rate)
        whole = arm.energy(q, v, FREE)
        assert np.ptp(q[0]) > 1.0
        return np.ptp(whole) / np.ptp(whole - arm.energy(q, 0 * v, FREE))

    assert drift(8000) < 0.01
    assert drift(16000) == pytest.approx(0.5 * drift(8000), rel=0.2)


def test_dry_friction_above_the_weight_holds_a_joint_still():
    held = FREE._replace(other_stiff=1e4, other_damped=30.0)
    weight = abs(arm.inverse(*(np.array([[x], [0.0]]) for x in (1.0, 0.0, 0.0)), FREE)[0, 0])
    wanted = np.tile([1.0, 0.0, 0.0, 0.0], (2000, 1))
    for factor, moves in ((1.3, False), (0.7, True)):
        _, v, _ = arm._played(wanted, held, Hidden(level=factor * weight), memory(), 0.0, 1 / FINE)
        assert np.any(np.abs(v[0, 500:]) > 1e-3) == moves


def test_the_arm_is_the_one_that_its_file_describes():
    text = arm.BODY.format(**LINKS._asdict())
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    rng = np.random.default_rng(3)
    for _ in range(5):
        q, v, a = rng.uniform(-2, 2, (3, 2, 1))
        data.qpos[:], data.qvel[:], data.qacc[:] = q[:, 0], v[:, 0], a[:, 0]
        mujoco.mj_inverse(model, data)
        np.testing.assert_allclose(data.qfrc_inverse, arm.inverse(q, v, a, LINKS)[:, 0], rtol=1e-6)


def test_a_load_at_the_tip_is_a_mass_there():
    share, (q, v, a) = 0.5, np.random.default_rng(4).uniform(-1, 1, (3, 2, 1))
    alone = LINKS._replace(m2=share * LINKS.m2, c2=LINKS.l2, i2=0.0, m1=0.0, i1=0.0)
    both = arm.inverse(q, v, a, LINKS) + arm.inverse(q, v, a, alone)
    np.testing.assert_allclose(arm.inverse(q, v, a, arm.loaded(LINKS, share)), both)


def test_a_bench_at_constant_speed_reads_its_friction():
    wanted = 0.3 * np.arange(5000) / FINE
    hidden = Hidden(level=0.2, excess=0.1, stribeck_speed=0.3, way=0.005)
    effort = bench.play(machine(bench.Bench(0.02, 0.05)), hidden, Plan(wanted, 0 * wanted)).effort
    assert effort[0] < 0.05
    assert effort[-1] == pytest.approx(0.05 * 0.3 + 0.2 + 0.1 * np.exp(-1.0))
    assert np.all(np.diff(effort) > -1e-9)


@pytest.mark.parametrize("name", list(SIMULATORS))
def test_every_kind_that_it_names_changes_what_is_logged(name):
    simulator = SIMULATORS[name]
    scale = Scale(0.3, 1.0, 0.0, 1.0, 2.0, True, 1.0)
    for kind in sorted(simulator.kinds - {"none"}):
        rng = np.random.default_rng(7)
        drawn = simulator.draw(rng, frozenset({kind}), 1.0)
        made = hiding(kind, scale, rng)
        asked = plan("tones", rng, 3.0, drawn.stroke, 1.0)
        found = [
            reported(simulator.play(drawn, hidden, asked), drawn, hidden)
            for hidden in (NOTHING, Hidden(**made.at(min(1.0, made.most))))
        ]
        moved = [np.column_stack([m.q, m.effort]) for m in found]
        assert np.all(np.isfinite(moved[1])), kind
        assert np.max(np.abs(moved[1] - moved[0])) > 0.0, kind
    assert simulator.kinds - {"none"} <= set(KINDS)


@pytest.mark.parametrize("motion", ["tones", "moves", "sweep", "scan", "one way"])
def test_plans_keep_to_their_stroke_and_begin_gently(motion):
    made = plan(motion, np.random.default_rng(2), 8.0, 3.0, 0.8)
    v = np.diff(made.wanted) * FINE
    if motion == "one way":
        assert np.all(v > 0) or np.all(v < 0)
    else:
        assert np.ptp(made.wanted) < 1.7 * 3.0
        assert v.max() > 0 > v.min()
    assert np.max(np.abs(np.diff(v))) * FINE < 3.0 * (2 * np.pi * 0.8) ** 2 * 3.0
