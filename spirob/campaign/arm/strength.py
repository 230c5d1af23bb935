"""How strong a hidden effect is drawn, and how strongly each kind shows in a robot.

Naming a hidden effect shall be neither trivial nor impossible, so its strength is drawn so that
knowing the effect would bring the held-out error to a ratio between two of what it is without, from
√(f² + (v s)²) to f: f is left with nothing hidden, and v is what the effect leaves at strength 1
after all numbers of the model are fitted.  The ratios are 0.3 and 0.35 where nothing else is
asked.  From 0.53 on an effect of a robot as designed carries less than 0.3 % of the current, the
model's own resolution, and diagnosis calls nothing an effect that carries less.

python -m spirob.campaign.arm.strength --seeds 917 918 919 [--kinds KIND ...] [--jobs N]

Each robot plays the trial's bends, the model's numbers are fitted without any effect, and of the
held-out error what is left with nothing hidden is taken off.  Kinds that are not linear in their
strength are measured near the error that the trial draws: once, and again at the strength which
that measurement asks for.  What is printed is % of the effort at strength 1.
"""

import argparse
import math
from collections.abc import Mapping, Sequence

import numpy as np
from joblib import Parallel, delayed

from spirob.campaign.arm.bends import problems_of, recorded
from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.fitting import Begun, begun, roughly
from spirob.emulator.build import AS_DESIGNED, TYPICAL
from spirob.emulator.rig import HiddenSettings
from spirob.ending import end_with_parent
from spirob.errors import ConfigError
from spirob.identify.fit import STEPS, Fit
from spirob.identify.problem import FITTED, Problem, effort_rms
from spirob.identify.residual import Residual
from spirob.plant import Plant, Rig

# % of the current's RMS with nothing hidden: 0.18 to 0.21 held out on five robots as designed; of
# other builds each leaves its own
LEFT = 0.19
RATIOS = (0.3, 0.35)  # of the errors with and without knowing: the strongest and weakest drawn
LARGEST = 3.0  # strength
FACTOR = 4.0  # of one adjustment, at most
NOTHING = 0.1  # of what is wanted, what is left is nearly nothing
POWERS = (0.5, 3.0)  # of the strength, with which what it leaves may grow

# % of the current's RMS that strength 1 leaves after the model's numbers are fitted, as measured on
# one robot near the strengths that are drawn; six kinds that are far from linear, or differ most
# between robots, are set between what two tries showed.  Where a robot shows its effect too little
# or too much its strength is adjusted.  Three kinds are no question for these logs: the efficiency
# takes up `current_gain`; lengths count from the arm's own pose, which hides all of
# `rest_curvature` but its second order; and these bends hardly show `stiffness_hardening`.
VISIBLE = {
    "asymmetric_viscous": 1.15,
    "back_driving_loss": 12,
    "cogging": 4,
    "constant_pull": 1.46,
    "current_lag": 9.37,
    "current_offset": 1.5,
    "driver_dead_band": 2.6,
    "drum_build_up": 0.887,
    "eccentric_drum": 7.38,
    "encoder_eccentricity": 3.2,
    "feedback_latency": 4.28,
    "gear_backlash": 6.4,
    "gear_compliance": 4.4,
    "guide_friction": 3.13,
    "joint_creep": 0.45,
    "load_friction": 11,
    "magnetic_saturation": 5,
    "mount_tilt": 0.5,
    "quadratic_drag": 0.886,
    "rotor_friction": 5.48,
    "tendon_creep": 11.9,
    "tendon_stretch": 10.2,
    "tight_spot": 1.9,
    "tip_payload": 1.29,
    "torque_ripple": 8.49,
    "winding_heating": 4.11,
}


def beside(whole: float, rest: float) -> float:
    """The RMS that adds up with `rest` to `whole`."""
    return math.sqrt(max(0.0, whole**2 - rest**2))


def sizes(ratios: tuple[float, float] = RATIOS, nothing: float = LEFT) -> tuple[float, float]:
    """The least and the most that an effect is to leave unexplained [% of the current's RMS].

    nothing  what is left with nothing hidden, in the same unit
    """
    return beside(nothing / ratios[1], nothing), beside(nothing / ratios[0], nothing)


def drawn_size(
    rng: np.random.Generator, ratios: tuple[float, float] = RATIOS, nothing: float = LEFT
) -> float:
    """How much an effect is to leave unexplained, in % of the current's RMS."""
    return float(rng.uniform(*sizes(ratios, nothing)))


def strength_of(kind: str, size: float) -> float:
    """The strength at which a kind is expected to leave `size`; 1 where nothing is hidden.

    Raises ConfigError for a kind that is none of the trial's.
    """
    if kind == "none":
        return 1.0
    if kind not in VISIBLE:
        raise ConfigError(f"trial: no kind '{kind}'; kinds: {', '.join(VISIBLE)}")
    return min(LARGEST, size / VISIBLE[kind])


def adjusted(tries: Sequence[tuple[float, float]], wanted: float) -> float:
    """The strength to try next where earlier ones showed more or less than `wanted`.

    tries  (strength, % of the current's RMS that it left), the latest last.  What is left grows as
           a power of the strength: 1 at first, then as the last two tries tell, or between the
           nearest on either side, once there are
    """
    below = max((t for t in tries if t[1] <= wanted), default=(0.0, 0.0))
    above = min((t for t in tries if t[1] > wanted and t[0] > below[0]), default=None)
    if above and below[0] > 0.0:
        return _between(below, above, wanted)
    strength, shown = tries[-1]
    power = 1.0
    if len(tries) > 1 and min(shown, tries[-2][1]) > 0.0 and strength != tries[-2][0]:
        rise = math.log(shown / tries[-2][1]) / math.log(strength / tries[-2][0])
        power = min(max(rise, POWERS[0]), POWERS[1])
    ratio = wanted / max(shown, 1e-3 * wanted)
    factor = min(FACTOR, max(1.0 / FACTOR, ratio ** (1.0 / power)))
    return min(LARGEST, strength * factor)


def _between(below: tuple[float, float], above: tuple[float, float], wanted: float) -> float:
    """The strength between two tries where a power of it shows what is wanted.

    Halfway where the weaker try showed as good as nothing: play in a gear sets in all at once.
    """
    least = NOTHING * wanted
    share = 0.5
    if below[1] > least:
        share = math.log(wanted / below[1]) / math.log(above[1] / below[1])
    return float(below[0] * (above[0] / below[0]) ** share)


def left(base: Fit, problems: Mapping[str, Problem]) -> float:
    """RMSE of the fitted numbers without any effect, in % of the effort's RMS.

    On trials that were not fitted, those that decide and those that are reported.
    """
    unseen = [problems[role] for role in ("validate", "heldout")]
    shares = [float(np.mean(p(base.changes)[p.rows] ** 2)) / effort_rms(p) ** 2 for p in unseen]
    return 100.0 * float(np.sqrt(np.mean(shares)))


def shown_by(hidden: HiddenSettings, seed: int) -> float:
    """The same of one robot, recorded and fitted for this."""
    problems = problems_of(recorded(hidden, seed), Plant(Rig(), []))
    return left(begun(problems["train"], FITTED, {}, Settings(intervals=False)).fit, problems)


def nothing(seed: int, build: str = AS_DESIGNED) -> float:
    """The same of a robot with nothing hidden."""
    return shown_by(HiddenSettings("none", build=build), seed)


def visible(kind: str, seed: int, plain: float) -> tuple[str, int, list[float], list[float]]:
    """Strengths tried in one robot, and what each shows per strength [% of the effort].

    plain  what is left in the same robot with nothing hidden
    """
    wanted = float(np.mean(sizes()))
    strength = strength_of(kind, wanted)
    tries: list[tuple[float, float]] = []
    for _ in range(2):
        shown = beside(shown_by(HiddenSettings(f"{kind}:{strength:.6g}"), seed), plain)
        tries.append((strength, shown))
        strength = adjusted(tries, wanted)
    return kind, seed, [s for s, _ in tries], [shown / s for s, shown in tries]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table, kind by kind."""
    parser = argparse.ArgumentParser(description="how strongly each hidden kind shows")
    parser.add_argument("--seeds", type=int, nargs="+", required=True)
    parser.add_argument("--kinds", nargs="+", default=sorted(VISIBLE), choices=sorted(VISIBLE))
    parser.add_argument("--jobs", type=int, default=-1)
    given = parser.parse_args(arguments)
    run = Parallel(given.jobs, return_as="generator", initializer=end_with_parent)
    plain = dict(zip(given.seeds, run(delayed(nothing)(s) for s in given.seeds), strict=True))
    print(f"nothing hidden leaves {plain}", flush=True)
    jobs = [delayed(visible)(k, s, plain[s]) for k in given.kinds for s in given.seeds]
    found: dict[str, list[float]] = {}
    for kind, seed, strengths, shown in run(jobs):
        found.setdefault(kind, []).append(shown[-1])
        print(f"{kind} {seed}: {np.round(strengths, 3)} shows {np.round(shown, 3)}", flush=True)
    for kind, values in found.items():
        middle = float(np.exp(np.mean(np.log(np.maximum(values, 1e-3)))))
        print(f'    "{kind}": {middle:.3g},')


if __name__ == "__main__":
    main()


TRIES = 5  # recordings of one robot, until its effect shows about as much as is wanted
NEAR = (0.9, 1.25)  # of the least and of the most that is drawn: near enough


def drawn(
    kind: str,
    seed: int,
    robot: int,
    plant: Plant,
    settings: Settings,
    ratios: tuple[float, float] = RATIOS,
    build: str = TYPICAL,
) -> tuple[HiddenSettings, Mapping[str, Residual], Begun]:
    """What is hidden, as strong as is wanted; the robot's trials; the fit without any effect.

    Of two kinds each is as strong as it would be alone in the same robot.

    kind    one, or two joined by "+";  seed  draws the strength;  robot  its seed
    ratios  between which knowing the effect is to bring the error
    build   how the robot is built
    """
    alone = [_alone(each, seed, robot, plant, settings, ratios, build) for each in kind.split("+")]
    if len(alone) == 1:
        return alone[0]
    hidden = HiddenSettings("+".join(each.effect for each, _, _ in alone), build=build)
    problems = problems_of(recorded(hidden, robot), plant)
    return hidden, problems, _without_any(problems, settings)


def _alone(
    kind: str,
    seed: int,
    robot: int,
    plant: Plant,
    settings: Settings,
    ratios: tuple[float, float],
    build: str,
) -> tuple[HiddenSettings, Mapping[str, Residual], Begun]:
    """One kind in a robot: how it shows depends on the robot, so where that is less or more than is
    ever drawn the robot is recorded again, at the strength that its logs ask for."""
    known = kind == "none" or build == AS_DESIGNED
    own = LEFT if known else nothing(robot, build)  # builds differ in it by a factor of three
    wanted = drawn_size(np.random.default_rng([seed, *kind.encode()]), ratios, own)
    strength = strength_of(kind, wanted)
    tries: list[tuple[float, float]] = []
    played = []
    while True:
        effect = "none" if kind == "none" else f"{kind}:{strength:.6g}"
        hidden = HiddenSettings(effect, build=build)
        problems = problems_of(recorded(hidden, robot), plant)
        first = _without_any(problems, settings)
        tries.append((strength, beside(left(first.fit, problems), own)))
        beyond = _beyond(tries[-1][1], sizes(ratios, own))
        played.append((beyond, hidden, problems, first))
        if kind == "none" or beyond == 0.0 or len(tries) == TRIES:
            break
        strength, before = adjusted(tries, wanted), strength
        if strength == before:  # the strongest that is drawn
            break
    return min(played, key=lambda p: p[0])[1:]


def _without_any(problems: Mapping[str, Problem], settings: Settings) -> Begun:
    """The numbers fitted without any effect, with wide differences first, then to the end."""
    train = problems["train"]
    found = roughly(train, FITTED, {}, settings, STEPS[:1])
    return begun(train, FITTED, found.changes, settings, STEPS[-1:])


def _beyond(shown: float, asked: tuple[float, float]) -> float:
    """By what factor an effect shows less or more than is near enough, as a logarithm."""
    inside = min(max(shown, NEAR[0] * asked[0]), NEAR[1] * asked[1])
    return abs(math.log(max(shown, 1e-3) / inside))
