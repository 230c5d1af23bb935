"""The wraps of a configuration: what is drawn depends on nothing but its own number."""

from pathlib import Path

import pytest

from pipeline.checks import check
from pipeline.config import composed
from pipeline.schema import validated
from pipeline.trials import compared_wraps, paper_wraps, robot_wraps, train_wraps, unseen_wraps
from spirob.errors import ConfigError

ROOT = Path(__file__).parents[2]


def config(*overrides):
    return validated(composed(ROOT, list(overrides)), "conf")


def diameter(trial):
    return trial["scene"]["cylinder"]["diameter"]


@pytest.fixture(scope="module")
def default():
    return config()


@pytest.fixture(scope="module")
def few():
    return config("perceive=paper")


def test_the_papers_samples_come_first(default):
    assert len(paper_wraps(default)) == 35
    assert train_wraps(default)[:35] == paper_wraps(default)


def test_the_set_is_large_continuous_and_varied(default):
    drawn = train_wraps(default)[35:]
    assert len(drawn) >= 500
    assert len({diameter(t) for t in drawn}) == len(drawn)
    for values in (
        [diameter(t) for t in drawn],
        [t["scene"]["cylinder"]["x"] for t in drawn],
        [t["scene"]["cylinder"]["friction"] for t in drawn],
        [t["motors"]["left"]["profile"]["blend"] for t in drawn],
    ):
        assert len(set(values)) > 0.9 * len(values)
    # a rest of up to 0.3 s before the start prolongs it, by whole milliseconds
    assert len({t["duration"] for t in drawn}) > 250
    assert 0.01 <= min(map(diameter, drawn)) < 0.012
    assert 0.068 < max(map(diameter, drawn)) <= 0.07


def test_the_papers_set_is_the_listed_wraps_alone(default, few):
    assert train_wraps(few) == paper_wraps(default)
    assert unseen_wraps(few) == unseen_wraps(default)
    assert robot_wraps(few) == robot_wraps(default)


def test_a_larger_set_begins_with_the_smaller_one(default):
    some, more = train_wraps(default), train_wraps(config("perceive.drawn.count=1400"))
    assert more[: len(some)] == some
    assert len(more) == 1435 > len(some)


def test_what_is_compared_comes_first_and_is_no_more_than_there_is(default, few):
    compared = compared_wraps(default)
    assert 300 < len(compared) < len(train_wraps(default))
    assert train_wraps(default)[: len(compared)] == compared
    assert compared_wraps(few) == train_wraps(few)


def test_what_is_tested_is_not_trained_on(default):
    trained = {diameter(t) for t in train_wraps(default)}
    assert not trained & {diameter(t) for t in unseen_wraps(default) + robot_wraps(default)}
    names = [t["name"] for t in train_wraps(default) + unseen_wraps(default) + robot_wraps(default)]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("perceive.drawn.wrap.rest=-1", "rest = -1 is out of range"),
        ("+perceive.drawn.wrap.colour=1", "wrap has no setting 'colour'"),
        ("perceive.drawn.count=-1", "perceive.drawn.count"),
        ("+perceive.size.threshhold=0.5", "size has no number 'threshhold'"),
        ("+perceive.size.threshold=2.0", "threshold"),
        ("perceive.choose.threshold=[0.5,2.0]", "threshold = 2.0"),
        ("perceive.choose.threshold=[]", "'threshold' has no values"),
        ("+perceive.choose.colour=[1.0]", "size has no number 'colour'"),
    ],
)
def test_a_mistake_is_told_before_anything_is_played(override, said):
    with pytest.raises(ConfigError, match=said):
        check(config(override))
