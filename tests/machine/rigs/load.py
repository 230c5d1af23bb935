"""Machines whose load is not what its model says."""

import numpy as np

from tests.machine.rigs.axis import STEP, Case, description, driven, reference, trials_of

PENDULUM = """<mujoco><option gravity="0 0 -9.81"/><worldbody><body name="link">
<joint name="shoulder" type="hinge" axis="0 1 0"/>
<inertial pos="0 0 -0.15" mass="0.4" diaginertia="0.003 0.003 0.0001"/>
<site name="hand" pos="0 0 -0.3"/></body></worldbody></mujoco>"""


def pendulum(seed: int) -> Case:
    """A joint that swings a link known as MJCF, with something in its hand that is not."""
    rng = np.random.default_rng(seed)
    payload, viscous = rng.uniform(0.08, 0.25), rng.uniform(0.02, 0.08)
    inertia = 0.003 + 0.4 * 0.15**2 + payload * 0.3**2
    weight = 9.81 * (0.4 * 0.15 + payload * 0.3)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        def torque(q: float, v: float, t: float, u: float) -> float:
            return -viscous * v - weight * np.sin(q)

        return driven(torque, reference(rng, 1.2, 0.9), inertia, (25.0, 2.0))

    trials = trials_of(make, rng, 0.02)
    rig = description(
        body={"mjcf": "link.xml", "joint": "shoulder", "tip": "hand"},
        fit={"viscous": {"nominal": 0.1, "low": 0.0, "high": 5.0}},
    )
    files = {"link.xml": PENDULUM}
    return Case(rig, trials[:2], trials[2], {"named"}, [{"tip_payload"}], files)


def lever(seed: int) -> Case:
    """A joint with bristle friction that lifts a weight; no model file, and any zero."""
    rng = np.random.default_rng(seed)
    weight, viscous = rng.uniform(0.3, 1.0), rng.uniform(0.02, 0.08)
    zero, level, inertia = rng.uniform(-1.0, 1.0), rng.uniform(0.04, 0.1), 0.03

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        bristle = 0.0

        def torque(q: float, v: float, t: float, u: float) -> float:
            nonlocal bristle
            bristle = (bristle + STEP * v) / (1 + STEP * 60.0 * abs(v) / level)
            return -viscous * v - 60.0 * bristle - weight * np.sin(q - zero)

        return driven(torque, reference(rng, 1.2, 0.9), inertia, (8.0, 0.8))

    trials = trials_of(make, rng, 0.01)
    dry = {"coulomb_friction", "stribeck_friction", "presliding_friction"}
    return Case(description(), trials[:2], trials[2], {"named"}, [{"tip_payload"}, dry])


def magnets(seed: int) -> Case:
    """Magnets whose spacing shrinks along the way: periodic in no angle, and in no library."""
    rng = np.random.default_rng(seed)
    viscous, strength, pitch = 0.05, rng.uniform(0.15, 0.3), rng.uniform(1.2, 2.0)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        def torque(q: float, v: float, t: float, u: float) -> float:
            return -viscous * v - strength * np.sin(pitch * q * (1 + abs(q)))

        return driven(torque, reference(rng, 2.0, 0.8), 0.01, (8.0, 0.8))

    trials = trials_of(make, rng, 0.01)
    return Case(description(), trials[:2], trials[2], {"unknown"})


def spring(seed: int) -> Case:
    """A progressive spring on a bare axis: the library has springs for hinged bodies only."""
    rng = np.random.default_rng(seed)
    viscous, stiff, cubic = 0.05, rng.uniform(0.1, 0.3), rng.uniform(0.05, 0.2)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        def torque(q: float, v: float, t: float, u: float) -> float:
            return -viscous * v - stiff * q - cubic * q**3

        return driven(torque, reference(rng, 1.5, 0.8), 0.01, (8.0, 0.8))

    trials = trials_of(make, rng, 0.01)
    return Case(description(), trials[:2], trials[2], {"unknown"})


def belt(seed: int) -> Case:
    """The same joint driven by a belt: the log has the belt's way in mm, and its force."""
    swing, radius = pendulum(seed), 0.02
    for trial in (*swing.train, swing.test):
        trial["q"], trial["u"] = 1e3 * radius * trial["q"], trial["u"] / radius
    rig = {
        **swing.rig,
        "position": {"column": "q", "unit": "mm"},
        "effort": {"column": "u", "unit": "N", "kind": "force"},
        "body": {"mjcf": "link.xml", "tendon": "belt", "tip": "hand"},
        "fit": {"viscous": {"nominal": 100.0, "low": 0.0, "high": 1e4}},
    }
    tendon = '<tendon><fixed name="belt"><joint joint="shoulder" coef="0.02"/></fixed></tendon>'
    text = PENDULUM.replace("</mujoco>", f"{tendon}</mujoco>")
    return Case(rig, swing.train, swing.test, swing.verdicts, swing.must, {"link.xml": text})


def shaft(seed: int) -> Case:
    """A load that swings on its shaft at a few hertz."""
    rng = np.random.default_rng(seed)
    motor, load, viscous = 0.01, rng.uniform(0.01, 0.03), 0.1
    spring = load * (2 * np.pi * rng.uniform(4.5, 6.5)) ** 2
    damping = 0.1 * np.sqrt(spring * load)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        q2, v2 = 0.0, 0.0

        def torque(q: float, v: float, t: float, u: float) -> float:
            nonlocal q2, v2
            through = spring * (q - q2) + damping * (v - v2)
            v2 += STEP * through / load
            q2 += STEP * v2
            return -viscous * v - through

        return driven(torque, reference(rng, 1.5, 4.0), motor, (8.0, 0.8))

    trials = trials_of(make, rng, 0.005)
    return Case(description(), trials[:2], trials[2], {"named"}, [{"gear_compliance"}])


def play(seed: int) -> Case:
    """A load behind teeth that leave it some per cent of the way to itself."""
    rng = np.random.default_rng(seed)
    motor, load, viscous = 0.01, rng.uniform(0.01, 0.03), 0.1
    stiff, gap, rub = load * (2 * np.pi * 40.0) ** 2, rng.uniform(0.03, 0.08), 3.0 * load

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        q2, v2 = 0.0, 0.0

        def torque(q: float, v: float, t: float, u: float) -> float:
            nonlocal q2, v2
            twist = q - q2 - np.clip(q - q2, -gap / 2, gap / 2)
            through = stiff * twist + (0.5 * np.sqrt(stiff * load) * (v - v2) if twist else 0.0)
            v2 += STEP * (through - rub * v2) / load
            q2 += STEP * v2
            return -viscous * v - through

        return driven(torque, reference(rng, 1.5, 1.5), motor, (8.0, 0.8))

    trials = trials_of(make, rng, 0.005)
    return Case(description(), trials[:2], trials[2], {"named"}, [{"backlash"}])
