"""A spring of an axis is an effect: found with its rest and sign, and in the place of no other."""

import numpy as np
import pytest

from spirob.effects import all_effects, find_effects
from spirob.machine.axis import diagnose_recordings
from spirob.machine.description.rig import RigFile
from spirob.machine.laws import LEVER, SPRING, related
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.preparation import ready_of
from tests.machine.rigs import description

RIG = RigFile.model_validate(description())
KEPT = {"coulomb_friction", "constant_force", "current_offset", "quadratic_drag", "tip_payload"}
OTHERS = set(all_effects()) - KEPT - {SPRING}


def log(name, tones, spring=0.0, rest=0.0, dry=0.0, cubic=0.0, size=0.2):
    t = np.arange(0, 10, 5e-3)
    w = np.array(tones)[:, None]
    q = size * np.sum(np.sin(w * t), axis=0)
    v, a = size * np.sum(w * np.cos(w * t), axis=0), -size * np.sum(w**2 * np.sin(w * t), axis=0)
    u = 0.01 * a + 0.05 * v + spring * (q - rest) + cubic * q**3 + dry * np.tanh(v / 0.02)
    u += 0.01 * np.random.default_rng(len(name)).normal(size=len(t))
    return prepare(name, {"t": t, "q": q, "u": u}, RIG)


def diagnosed(tmp_path, rig=RIG, **acts):
    logs = [log("a", (3.0, 7.1), **acts), log("bb", (2.0, 5.3), **acts)]
    test = [log("ccc", (2.6, 6.1), **acts)]
    return diagnose_recordings(rig, tmp_path, logs, test, without=OTHERS).document


def names(document):
    return {effect["name"] for effect in document["effects"]}


@pytest.mark.parametrize(("spring", "rest"), [(1.0, 0.0), (1.0, 0.15), (1.0, 5.0), (-1.0, 0.1)])
def test_a_spring_is_named_with_its_rest_and_its_sign(tmp_path, spring, rest):
    document = diagnosed(tmp_path, spring=spring, rest=rest)
    assert document["verdict"] == "named"
    (found,) = document["effects"]
    assert (found["name"], found["equivalents"], found["rivals"]) == (SPRING, [], [])
    about = found["parameters"]
    assert about["stiffness"]["value"] == pytest.approx(spring, rel=0.01)
    assert about["stiffness"]["unit"] == "N·m/rad"
    assert about["bias"]["value"] == pytest.approx(-spring * rest, rel=0.01, abs=2e-3)
    assert document["ladder"][-1]["test"]["rmse"] < 0.05 * document["effort_rms"]["test"]


@pytest.mark.parametrize("rest", [0.0, 1.0])
def test_a_spring_and_dry_friction_are_both_named(tmp_path, rest):
    assert names(diagnosed(tmp_path, spring=0.5, rest=rest, dry=0.2)) == {
        SPRING,
        "coulomb_friction",
    }


@pytest.mark.parametrize("key", ["fit", "known"])
def test_a_spring_that_is_described_is_no_effect(tmp_path, key):
    spring = {"nominal": 1.0, "low": 0.0, "high": 10.0} if key == "fit" else 1.0
    given = description()
    given[key] = {**given.get(key, {}), "stiffness": spring}
    document = diagnosed(tmp_path, RigFile.model_validate(given), spring=1.0)
    assert document["verdict"] == "nothing_missing"
    assert document["excluded"][SPRING] == "the description has a spring"


def test_no_spring_is_named_where_friction_is_missing(tmp_path):
    assert names(diagnosed(tmp_path, dry=0.2)) == {"coulomb_friction"}


@pytest.mark.parametrize("size", [0.2, 1.0])
def test_a_spring_that_grows_with_the_way_is_no_straight_one_and_no_weight(tmp_path, size):
    """A straight one takes most of it, and over a large angle a weight beside it the rest."""
    document = diagnosed(tmp_path, spring=0.3, cubic=0.8 / size**2, size=size)
    assert document["verdict"] == "unknown"
    assert document["effects"] == []
    assert "cubic" in document["composed"]["terms"]


def test_a_spring_stands_beside_no_weight_and_no_constant_force(tmp_path):
    """It holds the one; with the other it makes a spring that grows with the way."""
    possible = ready_of(RIG, tmp_path, [log("a", (3.0, 7.1), size=1.0)], []).possible
    assert SPRING in {e.name() for e in possible}
    (spring,) = find_effects([SPRING])
    for pull in (*LEVER.values(), *find_effects(["constant_force", "current_offset"])):
        assert related(spring, [pull])
        assert related(pull, [spring])
        assert not related(pull, find_effects(["coulomb_friction"]))
    assert not related(spring, find_effects(["coulomb_friction", "cogging"]))
