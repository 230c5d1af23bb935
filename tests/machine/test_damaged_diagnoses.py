"""Logs as people have them, from the file to the verdict: the right answer, or a true sentence.

A machine with dry friction and a constant force is logged three times.  Each log is kept in a kind
of file of its own and hurt in ways of its own; units, clock and columns are drawn for all of them.
"""

from collections.abc import Callable
from contextlib import chdir
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

import spirob
from spirob.errors import DataError
from spirob.machine.result import Diagnosis
from tests.machine.damages import DAMAGES, TURN, Log, Machine, late_speed, no_speed, scaled_speed
from tests.machine.written_logs import (
    BUSES,
    DATES,
    DBC,
    EFFORTS,
    FILES,
    FRAME,
    POSITIONS,
    SPEEDS,
    TIMES,
    Kept,
    written,
)

INERTIA, VISCOUS, DRY, FORCE = 0.04, 0.15, 0.25, 0.1
SMOOTH = 0.03  # rad/s, within which dry friction turns round
SECONDS = 8.0
TRUE = {"coulomb_friction", "constant_force", "current_offset"}  # the last two are one here
NEAR = 0.15  # of dry friction: rows spread anew, or lost, blur its edges


def machine(seed: int) -> Machine:
    """The machine on a motion of three tones."""
    rng = np.random.default_rng(seed)
    tones = TURN * np.array([0.31, 0.87, 1.9]) * rng.uniform(0.9, 1.1, 3)
    phases, sizes = rng.uniform(0.0, TURN, 3), np.array([1.5, 0.5, 0.2])

    def moved(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        angle = np.outer(t, tones) + phases
        q, v = np.sin(angle) @ sizes, np.cos(angle) @ (sizes * tones)
        a = -np.sin(angle) @ (sizes * tones**2)
        return q, v, INERTIA * a + VISCOUS * v + DRY * np.tanh(v / SMOOTH) + FORCE

    return moved


def stands(log: Log) -> None:
    half = len(log) // 2
    log.columns["t"][half:] += 3.0
    log.columns["q"][half:], log.columns["v"][half:] = log.columns["q"][half], 0.0


def brief(log: Log) -> None:
    log.rows(slice(0, max(2, int(0.4 * log.rate))))


def still(log: Log) -> None:
    log.columns["q"][:], log.columns["v"][:] = log.columns["q"][0], 0.0


def effort_spikes(log: Log) -> None:
    log.columns["u"][log.rng.choice(len(log), 3, replace=False)] = [40.0, -1e9, np.inf]


def other_unit(log: Log) -> None:
    log.columns["u"] *= 1000.0


def turned(log: Log) -> None:
    log.columns["u"] *= -1.0


MACHINE = [stands, brief, still, effort_spikes, other_unit, turned]
HURTS: list[Callable[[Log], None]] = [*MACHINE, *DAMAGES]
OF_A_SECOND_SPEED = (scaled_speed, late_speed, no_speed)  # which nothing tells of a speed alone


@st.composite
def kept(draw: st.DrawFn) -> Kept:
    position = draw(st.sampled_from([*POSITIONS, ""]))
    speed = draw(st.sampled_from([*SPEEDS] if not position else [*SPEEDS, "", ""]))
    efforts = [e for e in EFFORTS if e != "control" or position]
    bus = draw(st.sampled_from(["", "", "", *BUSES]))
    times = [*TIMES] if bus else [*TIMES, DATES]
    return Kept(position, speed, draw(st.sampled_from(efforts)), draw(st.sampled_from(times)), bus)


LOGS = st.lists(
    st.tuples(
        st.sampled_from([50.0, 100.0, 200.0, 500.0]),
        st.sets(st.sampled_from(range(len(HURTS))), max_size=3),
        st.sampled_from([*FILES, FRAME]),
    ),
    min_size=3,
    max_size=3,
)


@dataclass
class Drawn:
    """A description and its logs, hurt."""

    kept: Kept
    logs: list[tuple[float, set[int], str]]
    seed: int

    def answer(self) -> Diagnosis:
        description = self.kept.description(
            name="joint",
            fit={
                "inertia": {"nominal": 0.05, "low": 0.001, "high": 1.0},
                "viscous": {"nominal": 0.1, "low": 0.0, "high": 3.0},
            },
            criteria={"most": 2},
        )
        with TemporaryDirectory() as folder:
            if self.kept.bus == "can":
                (Path(folder) / "a.dbc").write_text(DBC)
                description["dbc"] = "a.dbc"
            made = []
            for k, (rate, hurts, kind) in enumerate(self.logs):
                log = Log(machine(3 * self.seed + k), rate, self.seed + k, SECONDS)
                for h in sorted(hurts):
                    if self.kept.position or HURTS[h] not in OF_A_SECOND_SPEED:
                        HURTS[h](log)
                made.append(
                    written(
                        self.kept.columns(log.columns),
                        self.kept.time == DATES,
                        self.kept.bus or kind,
                        Path(folder) / f"log{k}",
                    )
                )
            with chdir(folder):
                return spirob.diagnose(description, train=made[:2], test=made[2:])


def is_right(found: Diagnosis, drawn: Drawn) -> bool:
    """Dry friction is named with its size, and nothing that is not there.

    Where every log that can be used has another unit, nothing tells that it is another.
    """
    of_logs = [{HURTS[h] for h in hurts} for _, hurts, _ in drawn.logs]
    other = all(hurts & {other_unit, brief, still} for hurts in of_logs)
    dry = (1000.0 if other else 1.0) * DRY
    names = {(TRUE & {f.name, *f.equivalents} or {f.name}).pop(): f for f in found.findings}
    if found.verdict != "named" or not {"coulomb_friction"} <= set(names) <= TRUE:
        return False
    level = next(iter(names["coulomb_friction"].numbers.values()))  # first of any dry friction
    return abs(level["value"] - dry) < NEAR * dry


PLAIN = Kept(position="rad", speed="", effort="A", time="s", bus="")
ANOTHER_UNIT = Drawn(PLAIN, [(100.0, {HURTS.index(other_unit)}, "csv")] * 3, 1)


@example(ANOTHER_UNIT)
@settings(max_examples=4, deadline=None, derandomize=True)
@given(st.builds(Drawn, kept(), LOGS, st.integers(0, 2**20)))
def test_hurt_logs_of_any_kind_end_in_the_right_name_or_a_sentence(drawn):
    """What is hurt may leave no name, or be refused; a wrong name or number it never gives."""
    hurt = any(hurts for _, hurts, _ in drawn.logs)
    try:
        found = drawn.answer()
    except DataError as error:
        assert hurt
        assert "\n" not in str(error)
        return
    assert is_right(found, drawn) or (hurt and found.verdict != "named"), found.sentence
    assert found.notes or found.document["doubts"] or not hurt
