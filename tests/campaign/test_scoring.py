"""What counts as right, as right and more, as open and as wrong."""

import pytest

from spirob.campaign.running import features
from spirob.campaign.scoring import group, lines, outcome, rates


def result(must, verdict, *effects, near=(), inside=True, shown=True, hidden=None, besides=()):
    """A result; an effect is a name, or a name with its probability, equivalents and rivals."""
    full = [(e, 1.0, [], []) if isinstance(e, str) else e for e in effects]
    keys = ("name", "probability", "equivalents", "rivals")
    found = {
        "simulator": "rigid",
        "refused": "",
        "crashed": "",
        "truth": {
            "hidden": hidden if hidden is not None else [names[0] for names in must],
            "inside": inside,
            "must": must,
            "besides": list(besides),
            "near": list(near),
            "can_be_shown": shown,
        },
        "said": {"verdict": verdict, "effects": [dict(zip(keys, e, strict=True)) for e in full]},
    }
    return found | {"outcome": outcome(found)}


ONE, TWO = [["cogging"]], [["cogging"], ["coulomb_friction", "presliding_friction"]]
OUTSIDE = {"inside": False, "hidden": ["tight_spot"]}
ONE_WAY = {"inside": False, "hidden": ["stick_one_way"]}


@pytest.mark.parametrize(
    ("given", "word", "first", "sure_wrong"),
    [
        (result(ONE, "named", "cogging"), "exactly", True, False),
        (result(ONE, "named", ("torque_ripple", 1.0, ["cogging"], [])), "exactly", True, False),
        (result(ONE, "named", "cogging", "quadratic_drag"), "more", True, False),
        (result(ONE, "named", "quadratic_drag", "cogging"), "more", False, True),
        (result(ONE, "named", "quadratic_drag"), "wrong", False, True),
        (result(ONE, "named", ("quadratic_drag", 0.8, [], [])), "wrong", False, False),
        (result(ONE, "named", "stick", near=["stick"]), "partly", False, False),
        (result(ONE, "named", "cogging", "dry", besides=["dry"]), "exactly", True, False),
        (result(ONE, "unknown"), "unknown", False, False),
        (result(ONE, "nothing_missing"), "missed", False, False),
        (result(TWO, "named", "presliding_friction", "cogging"), "exactly", True, False),
        (result(TWO, "named", "cogging"), "first", True, False),
        (result([], "nothing_missing", hidden=[]), "exactly", False, False),
        (result([], "named", "cogging", hidden=[]), "wrong", False, True),
        (result([], "unknown", hidden=[]), "unknown", False, False),
        (result([], "unknown", **OUTSIDE), "exactly", False, False),
        (result([], "undecided", "cogging", **OUTSIDE), "exactly", False, False),
        (result([], "named", "cogging", **OUTSIDE), "wrong", False, True),
        (result([], "named", "dry", near=["dry"], **OUTSIDE), "partly", False, False),
        (result([], "named", "constant_force", **OUTSIDE), "wrong", False, True),
        (result([], "named", "constant_force", **ONE_WAY), "partly", False, False),
        (result([], "nothing_missing", **OUTSIDE), "missed", False, False),
        (result(ONE, "nothing_missing", shown=False), "exactly", False, False),
        (result(ONE, "named", "cogging", shown=False), "exactly", True, False),
        (result(ONE, "named", "quadratic_drag", shown=False), "wrong", False, True),
    ],
)
def test_each_answer_has_its_word(given, word, first, sure_wrong):
    found = given["outcome"]
    assert (found["word"], found["first"], found["sure_wrong"]) == (word, first, sure_wrong)


def test_undecided_says_whether_the_right_names_are_among_those_in_question():
    for rivals, among in ((["cogging"], True), (["quadratic_drag"], False)):
        given = result(ONE, "undecided", ("torque_ripple", 0.6, [], rivals))
        assert given["outcome"]["word"] == "undecided"
        assert given["outcome"]["among"] == among


def test_a_table_counts_each_group_by_simulator():
    results = [
        result(ONE, "named", "cogging"),
        result(ONE, "unknown"),
        result([], "nothing_missing", hidden=[]),
        result([], "unknown", **OUTSIDE) | {"simulator": "arm"},
        result(ONE, "unknown", shown=False),
    ]
    assert [group(r) for r in results] == ["one", "one", "none", "outside", "not to be seen"]
    beside = result(ONE, "unknown", hidden=["cogging", "tight_spot"])
    assert group(beside | {"truth": beside["truth"] | {"beside": True}}) == "one beside"
    table = rates(results)
    assert table["one"]["all"]["exactly"]["value"] == 0.5
    assert table["one"]["all"]["words"] == {"unknown": 1}
    assert set(table["outside"]) == {"all", "arm"}
    text = "\n".join(lines(table))
    assert "50.0% [9%, 91%]" in text
    assert text.count("\n") == 1 + 2 * 4 - 1


def number(value, low, high):
    return {"value": value, "low": low, "high": high, "unit": "1"}


def test_features_are_those_of_the_model_that_the_search_stands_by():
    def rung(names, train, test):
        return {"effects": names, "train": {"rmse": train}, "test": {"rmse": test}}

    document = {
        "ladder": [
            rung([], 4.0, 4.0),
            rung(["a"], 1.0, 2.0),
            rung([], 0.5, 0.5) | {"ceiling": True},
        ],
        "candidates": [
            {"name": n, "heldout_rmse": e, "probability": p}
            for n, e, p in (("a", 2.0, 0.97), ("b", 2.1, 0.02), ("c", 4.0, 0.0), ("d", None, 0.0))
        ],
        "numbers": {"delay": number(0.01, -0.01, 0.01), "inertia": number(2.0, 1.9, 2.1)},
        "effects": [{"probability": 0.97, "parameters": {"size": number(0.5, 0.4, 0.6)}}],
        "effort_rms": {"train": 5.0, "test": 4.0},
        "noise_floor": 0.5,
        "left": {"share": 0.2},
        "repairs": ["one"],
        "evidence": [{"name": "a", "figures": {"wins": 0.97}}],
    }
    found = features(document)
    assert found["chosen"] == ["a"]
    assert found["evidence"] == document["evidence"]
    assert found["stated"] == 0.97
    assert found["taken"] == 0.75
    assert found["gain"] == pytest.approx(1 - (2.0 / 2.1) ** 2)
    assert found["close"] == 1
    assert found["numbers"] == 3
    assert found["at_bound"] == 1
    assert found["delay"] == 0.01
    assert found["remaining"] == 0.5
