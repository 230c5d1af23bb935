"""Every preset is an experiment whose trials can be played, and a mistake in one is a sentence."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from pipeline.checks import check
from pipeline.config import composed
from pipeline.schema import validated
from spirob.errors import ConfigError
from spirob.experiments import SIDES, Side, experiment_from, experiments, repeating
from spirob.plant.plant import Motion
from spirob.trials import Trial

ROOT = Path(__file__).parents[2]
CONF = ROOT / "conf" / "paper"
EXPERIMENTS = experiments()
COLUMNS = {"what", "unit", "robot", "base", "named", "single", "paper", "aim", "met", "note"}


PASSIVE = ("single_contact", "periodic_contact", "host_contact", "host_periodic")


def test_what_is_played_by_default_is_found():
    """An experiment that goes missing must not take its tests with it."""
    assert len(EXPERIMENTS) >= 8
    assert set(composed(ROOT, [])["paper"]) <= set(EXPERIMENTS)


def preset(name):
    return yaml.safe_load((CONF / f"{name}.yaml").read_text())


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_a_preset_is_playable_and_names_every_setting(name):
    experiment = experiment_from(name, preset(name))
    plays = experiment.plays()
    assert len({p.name for p in plays}) == len(plays)
    for play in plays:
        assert Trial.from_plain(play.trial).name == play.name
    for key, value in preset(name).items():
        own = getattr(experiment, key)
        assert (list(own) if isinstance(own, tuple) else own) == value


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_a_preset_runs_alone(name):
    """Identification sees what it always sees; of the paper's experiments one is played."""
    plain = composed(ROOT, [f"paper={name}"])
    assert list(plain["paper"]) == [name]
    assert plain["paper"][name] == preset(name)
    assert plain["recordings"] == composed(ROOT, [])["recordings"]
    check(validated(plain, "conf"))


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_sides_that_answer_alike_score_alike(name):
    """A robot that is the model: every figure of one is that of the other, and aims are met."""
    experiment = experiment_from(name, {})
    sides = {play.name: played(play, experiment) for play in experiment.plays()}
    rows = experiment.measure(sides)
    assert all(set(row) == COLUMNS for row in rows)
    for row in rows:
        if "RMSE" in row["what"]:
            assert row["named"] == 0.0
        elif not row["what"].startswith("rank agreement") and row["robot"] is not None:
            assert row["robot"] == row["named"] == row["base"]
        if row["met"] is not None and "contacts" not in row["what"]:
            assert row["met"], row
    drawn = experiment.curves(sides)
    assert {c["side"] for c in drawn} >= {"robot", "base", "named"}
    assert all(len(c["x"]) == len(c["y"]) > 1 for c in drawn)


@pytest.mark.parametrize("name", PASSIVE)
def test_every_figure_of_a_current_has_the_reconstructed_one_beside_it(name):
    experiment = experiment_from(name, {})
    sides = {play.name: played(play, experiment) for play in experiment.plays()}
    for answers in sides.values():
        for model in {"base", "named"} & set(answers):
            current = answers[model].current + 50.0 * answers[model].displacement
            answers[model] = replace(answers[model], current=current, arm_current=2.0 * current)
    counts = [c for c in experiment.curves(sides) if c["unit"].startswith("counts")]
    named = [c for c in counts if c["side"] == "named" and "angle" not in c["quantity"]]
    measured = [c for c in named if "reconstructed" not in c["quantity"]]
    assert measured
    for one in measured:
        beside = [c for c in named if c["play"] == one["play"] and c not in measured]
        twice = [2.0 * y for y in one["y"]]
        assert np.ptp(twice) > 0.01
        assert any(c["y"] == pytest.approx(twice, abs=1e-5) for c in beside), one["quantity"]


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_without_a_robot_the_model_is_measured_alone(name):
    """Hardware is not driven by the pipeline."""
    experiment = experiment_from(name, {})
    sides = {play.name: played(play, experiment) for play in experiment.plays()}
    for answers in sides.values():
        answers.pop("robot", None)
    rows = experiment.measure(sides)
    assert all(row["robot"] is None and row["met"] is None for row in rows)
    assert any(row["named"] is not None for row in rows)
    assert "robot" not in {c["side"] for c in experiment.curves(sides)}


def played(play, experiment):
    """A made-up answer that depends on the trial's place: a lag, a sway and a stall."""
    cycles = Trial.from_plain(play.trial).cycles
    t = np.arange(cycles) * 1e-3
    tail = play.name.rpartition("_")[2]
    size = float(tail) / 100 if tail.isdigit() else 0.0
    x = 0.05 * np.minimum(t, 2.0) + 1e-3 * size * np.sin(2 * np.pi * t) * (t > 0.5)
    v = np.gradient(x, 1e-3)
    i = 0.5 + 0.1 * np.sin(t) + size * (t > 0.8 * cycles * 1e-3) + 4 * (t > 2.0)
    two = [np.column_stack([s, s]) for s in (i, x, v, i)]
    answer = Side(*two)
    force = np.zeros((cycles, 24))
    bare = Side.from_motion(Motion(two[1], two[2], force), two[3])
    names = play.only or SIDES
    if play.repeat:
        names = (*names, repeating("base"), repeating("named"))
    return {s: bare if s == "single" else answer for s in names}


@pytest.mark.parametrize(
    ("name", "given", "said"),
    [
        ("dance", {}, "no experiment 'dance'"),
        ("delay", {"forcs": [1.0]}, "paper.delay has no key 'forcs'"),
        ("delay", {"forces": 1.0}, "paper.delay.forces must be a list"),
        ("delay", {"forces": ["a"]}, "must be a finite number"),
        ("hysteresis", {"period": -1}, "must not be below 0"),
        ("hysteresis", {"period": True}, "must be a finite number"),
        ("delay", 3, "must be a mapping"),
        ("active_contact", {"again": 1.5}, "again = 1.5 must be a whole number"),
    ],
)
def test_a_mistake_is_a_sentence(name, given, said):
    with pytest.raises(ConfigError, match=said):
        experiment_from(name, given)
