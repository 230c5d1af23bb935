"""One typed document: what is written is checked, what is read has to be of this version."""

import json
from copy import deepcopy

import pandas as pd
import pytest

import spirob
from spirob.campaign.case import Case, drawn
from spirob.diagnosis.schema import FORMAT, LONGEST, Part, checked, unknown
from spirob.machine.diagnosis import failures_told


@pytest.fixture(scope="module")
def document():
    made = drawn(Case("bench", "coulomb_friction", 1))
    train = [pd.DataFrame(log) for log in made.train]
    found = spirob.diagnose(made.rig, train=train, test=[pd.DataFrame(made.test)])
    return json.loads(json.dumps(found.document))


def test_a_rigs_document_is_one(document):
    assert document["format"] == FORMAT
    assert unknown(document) == ""
    assert checked(document) == document


def parts(of=Part):
    """All types of which a document is made."""
    return [of, *(part for one in of.__subclasses__() for part in parts(one))]


@pytest.mark.parametrize("part", parts(), ids=lambda part: part.__name__)
def test_every_key_says_what_it_holds(part):
    assert part.__doc__
    told = part.model_json_schema(by_alias=True)
    for name, key in told.get("properties", {}).items():
        assert "$ref" in key or key.get("description"), name


def test_ends_that_the_data_do_not_tell_are_null(document):
    """As of a held-out log that is one block of draws."""
    known = deepcopy(document)
    known["ladder"][0]["interval"]["test"]["r2"] = [None, None]
    assert unknown(known) == ""
    known["ladder"][0]["interval"]["test"]["r2"] = [0.5]
    assert unknown(known).startswith("ladder.0.interval.test.r2")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"format": 2}, "it states format 2, where 1 is read; diagnose once more"),
        ({"verdict": "sure"}, "verdict: input should be 'named', 'undecided'"),
        ({"further": 1}, "further: extra inputs are not permitted"),
        ({"candidates": [{"name": "x"}]}, "candidates.0.title: field required"),
        ({"noise_floor": "0.1"}, "noise_floor: input should be a valid number"),
    ],
)
def test_what_is_none_is_refused_in_a_sentence(document, change, said):
    assert unknown({**deepcopy(document), **change}).startswith(said)


def test_a_document_without_a_format_is_of_another_version(document):
    before = {key: value for key, value in document.items() if key != "format"}
    assert unknown(before).startswith("it states no format, where 1 is read")


def test_a_sentence_stays_one_whatever_a_document_states(document):
    for change in ({"k\n" * 10_000: 1}, {"format": "k\n" * 10_000}):
        said = unknown({**document, **change})
        assert "\n" not in said
        assert len(said) < LONGEST + 80


def test_a_mistake_of_the_program_names_the_key_and_blames_no_log(document):
    with pytest.raises(AssertionError, match="sentence: "), failures_told("rig.yaml"):
        checked({**document, "sentence": 3})
