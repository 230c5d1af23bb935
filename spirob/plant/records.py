"""The records of the compiled loop: what it is told, what it remembers, what it answers.

Numbers of a record have a name here and in `loop`, where compiled code reads `s.tension[m]`; Python
reads the same memory by the same name.  Rows of two are the left and the right motor.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from spirob.plant.chain import ROWS

BOTH = (2,)
LINES = 6  # of a unit's outline
MORE = 2  # coordinates behind the hinges, at most, of what the arm touches


def _kind(fields: list[Any]) -> np.dtype:
    return np.dtype((np.record, fields))


STATE = _kind(
    [  # what lasts from cycle to cycle
        ("cycle", "f8"),  # cycles played so far
        ("current", "f8", BOTH),  # i* [A]
        ("integral", "f8", BOTH),  # of the drive's current loop [V]
        ("command", "f8", BOTH),  # i_cmd [A]
        ("command_integral", "f8", BOTH),  # of the feedback law [A]
        ("displacement", "f8", BOTH),  # x [m]
        ("rate", "f8", BOTH),  # w, of x [m/s]
        ("turned", "f8", BOTH),  # angle of the drum since the trial began [rad]
        ("first_angle", "f8", BOTH),  # of the rotor when the trial began [rad]
        ("radius", "f8", BOTH),  # of the drum as it is wound now [m]
        ("hung", "f8", BOTH),  # mass on a line of its own beside each tendon [kg]
        ("tension", "f8", BOTH),  # F [N]
        ("extra_length", "f8", BOTH),  # by which the tendon has grown [m]
        ("shortening", "f8", BOTH),  # Δl [m]
        ("shortening_rate", "f8", BOTH),  # v = dΔl/dt [m/s]
        ("rate_before", "f8", BOTH),  # v of the step before [m/s]
        ("pulled", "f8", BOTH),  # A F of the step before [m/s²]
        ("unpulled", "f8", BOTH),  # a, what all but the tendons does to v [m/s²]
        ("arm_current", "f8", BOTH),  # i** [A]
        ("reading_error", "f8", BOTH),  # of the reported length [m]; its rate is the velocity's
        ("reading_zero", "f8", BOTH),  # that error where the trial began [m]: lengths count from it
        ("volts", "f8", (3, 2)),  # of the host's loop, in this cycle and the two before [V]
        ("host_integral", "f8", BOTH),  # of (13) [V]
        ("host_error", "f8", BOTH),  # e of (13) [A]
    ]
)
PASSING = _kind(
    [  # what one step of a cycle leaves to the next
        ("time", "f8"),  # where the cycle began [s]
        ("last", "i8"),  # 1 where the state is told once more, after the last cycle
        ("substep", "i8"),  # of the cycle
        ("command_before", "f8", BOTH),  # i_cmd of the cycle before [A]
        ("misread", "f8", BOTH),  # what the current sensor says less the current [A]
        ("mean_current", "f8", BOTH),  # over the step [A]
        ("torque", "f8", BOTH),  # τ at the drum [N·m]
        ("rotor_damping", "f8", BOTH),  # slope of the torques at the rotor [N·m·s/rad]
        ("mobility", "f8", (2, 2)),  # A = J M⁻¹ Jᵀ [1/kg]
        ("free_rate", "f8", BOTH),  # w_f [m/s]
        ("weight", "f8", BOTH),  # m + h b [kg]
        ("give", "f8", BOTH),  # h c [kg]
        ("demand", "f8", BOTH),  # tension if nothing gave way to it [N]
        ("cycle_rate", "f8", BOTH),  # w where the cycle began [m/s]
        ("cycle_shortening_rate", "f8", BOTH),  # v there [m/s]
    ]
)
SETTINGS = _kind(
    [  # what the trial asks for, and the controller's numbers
        ("mode", "i8", BOTH),  # constants of `control`
        ("limit", "f8", BOTH),  # of the commanded current [A]
        ("velocity", "f8"),  # gains of `control`
        ("integral", "f8"),
        ("displacement", "f8"),
        ("force", "f8"),
        ("newton_per_ampere", "f8"),
        ("drag", "f8"),
        ("radius", "f8"),  # of the drum, as the drive's report is read [m]
        ("substeps", "i8"),  # in a cycle
        ("step", "f8"),  # length of one [s]
        ("cycle", "f8"),  # length of all [s]
        ("drive_steps", "i8"),  # samples of the drive in one
        ("host_resistance", "f8"),  # what the host believes of the winding [Ω]
        ("host_inductance", "f8"),  # [H]
        ("host_emf", "f8"),  # [V·s/rad]
        ("host_proportional", "f8"),  # gains of (13) [V/A]
        ("host_integral", "f8"),  # [V/(A·s)]
        ("host_derivative", "f8"),  # [V·s/A]
        ("host_limit", "f8"),  # [V]
        ("host_latency", "f8"),  # from a reading until its voltage acts [cycles]
        ("host_count", "f8"),  # of the voltage on the bus [V]
        ("host_current_count", "f8"),  # of the current that it reads [A]; 0: it reads all of it
        ("host_speed_count", "f8"),  # of the rotor's speed [rad/s]; the same
    ]
)
COLUMNS = (
    "current",
    "arm_current",
    "displacement",
    "velocity",
    "shortening",
    "shortening_rate",
    "tension",
    "command",
    "voltage",
)
NOISE = "noise"  # of the current that the host reads [A]; given, where the others are told
ROW = _kind([(name, "f8") for name in (*COLUMNS, NOISE)])  # of one motor in one cycle


@dataclass(frozen=True)
class Frames:
    """In what counts the host's loop reads a drive: current [A], speed of the rotor [rad/s].

    Zero is no count: it then reads what the drive measures.
    """

    current: float = 0.0
    speed: float = 0.0


@cache
def arm_kind(hinges: int) -> np.dtype:
    """The record of an arm of so many hinges N: what is known of them, and what a step makes of it.

    The compiled loop knows N from it, so an arm of another number of units is compiled anew.
    """
    return _kind(
        [
            ("alone", "i8"),  # 1 where nothing but the arm moves, so that `chain` may take steps
            ("gravity", "f8", (2,)),  # [m/s²]
            ("post", "f8", (3,)),  # a fixed cylinder: x, y, radius [m]
            ("stiffness", "f8", (hinges,)),  # [N·m/rad]
            ("units", "f8", (hinges + 1, 2)),  # mass [kg] and length [m]; the mass at the tip last
            ("hinge_weight", "f8", (hinges, 2)),  # torque by direction of gravity [N·m]
            (
                "guides",
                "f8",
                (10, hinges),
            ),  # rows of `tendon.guides`, turned, of the left tendon first
            (
                "rest",
                "f8",
                (2, hinges),
            ),  # length of each tendon at the hinges of the straight arm [m]
            ("lengths", "f8", (3, hinges)),  # scratch of `tendon.pose_tendons`
            ("lever", "f8", (2, hinges)),  # J: shortening of each tendon per hinge angle [m/rad]
            ("pull", "f8", (2, hinges + MORE)),  # J times the local tension ratio [m/rad]
            ("solved", "f8", (2, hinges + MORE)),  # M⁻¹ pull [m/rad/(kg·m²)]
            ("chain", "f8", (len(ROWS), hinges)),  # numbers of each unit (`chain.chain_of`)
            ("place", "f8", (8, hinges)),  # scratch of `chain`
            ("factor", "f8", (4, hinges)),
            ("work", "f8", (2, hinges)),
            ("bows", "f8", (hinges,)),  # move the units' outlines (`chain.bend_outline`)
            ("heights", "f8", (hinges, LINES)),
            ("outline", "i8", (hinges, LINES)),
        ]
    )


class Moved(NamedTuple):
    """The arm as MuJoCo moves it; hinges first, then what a ball or a peg adds.

    model, data  by address
    qpos, qvel, applied  (nv,) angles [rad], speeds [rad/s], torques [N·m]
    positions    (geoms, 3) of the units' outlines [m]
    pull, solved (2,) addresses of the rows of these in the arm's record
    """

    model: Any
    data: Any
    qpos: np.ndarray
    qvel: np.ndarray
    applied: np.ndarray
    positions: np.ndarray
    pull: Any
    solved: Any


@dataclass(frozen=True)
class Response:
    """What the model did, one row for each 1 kHz cycle; columns of the (T, 2) arrays: left, right.

    current          i* as the drive reports it [A], as the host's loop read it where there is one
    arm_current      i**, reconstructed from the arm's motion and the tension it feels [A]
    displacement     wound-in length as the encoder reports it [m];  velocity  its rate [m/s]
    shortening       Δl of the tendon [m];  shortening_rate [m/s]
    tension          [N];  command  commanded current [A]
    voltage          that the host sends [V]; zero where the drive closes the current loop
    angles           (T, N) hinge angles [rad]
    """

    current: np.ndarray
    arm_current: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    shortening: np.ndarray
    shortening_rate: np.ndarray
    tension: np.ndarray
    command: np.ndarray
    voltage: np.ndarray
    angles: np.ndarray


def made(kind: np.dtype) -> Any:
    """One record of zeros, as an array of one; its numbers are attributes of the first entry."""
    return np.zeros(1, kind)


class Layout:
    """The parameter vector as a record: `owner.field` of a table is `p.owner.field` in the loop.

    without  names that it leaves out: those of effects, so that the record is of one kind
    """

    def __init__(self, names: Sequence[str], without: Collection[str] = ()):
        owners: dict[str, list[int]] = {}
        for k, name in enumerate(names):
            if name in without:
                continue
            owners.setdefault(name.partition(".")[0], []).append(k)
        fields = {o: [(names[k].partition(".")[2], "f8") for k in own] for o, own in owners.items()}
        self._kind = _kind([(owner, _kind(own)) for owner, own in fields.items()])
        self._order = np.concatenate([*owners.values()])

    def of(self, vector: np.ndarray) -> np.ndarray:
        """The record of a vector in the table's order, an array of one."""
        return vector[self._order].view(self._kind)
