"""Machines nobody tuned for: the right effect is named, or that none is, or that it is unknown.

Seeds from 1000 on were not looked at while the search was built.
"""

import pytest

from tests.machine.judging import OTHERS, diagnosed, is_right
from tests.machine.rigs import CASES


@pytest.mark.parametrize("kind", CASES)
def test_the_verdict_on_an_unseen_machine_is_right(kind, tmp_path):
    case = CASES[kind](1000)
    document = diagnosed(case, tmp_path)
    names = [e["name"] for e in document["effects"]]
    assert is_right(case, document), (document["verdict"], names, document["sentence"])


def test_effort_that_ignores_the_motion_names_nothing(tmp_path):
    """Two motors' efforts exchanged: each log holds the motion of one and the effort of another."""
    case, other = CASES["crane"](1001), CASES["crane"](1002)
    for trial, strange in zip([*case.train, case.test], [*other.train, other.test], strict=True):
        trial["u"] = strange["u"]
    document = diagnosed(case, tmp_path)
    assert document["verdict"] in ("unknown", "nothing_missing")
    assert document["effects"] == []


def test_a_number_at_its_bound_is_set_free_and_said(tmp_path):
    """The inertia is far outside its bounds: what is missing is told all the same."""
    case = CASES["crane"](1004)
    case.rig["fit"]["inertia"] = {"nominal": 1e-3, "low": 1e-4, "high": 1e-2}
    document = diagnosed(case, tmp_path, OTHERS)
    assert is_right(case, document), document["sentence"]
    assert any("inertia ended at its bound" in said for said in document["repairs"])
