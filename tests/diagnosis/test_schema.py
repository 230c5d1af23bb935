"""One typed document: what is written is checked, what is read has to be of this version."""

import json
from copy import deepcopy

import pandas as pd
import pytest

import spirob
from spirob.campaign.case import Case, drawn
from spirob.diagnosis.schema import FORMAT, Document, checked, unknown


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


def test_every_key_says_what_it_holds():
    assert all(field.description for field in Document.model_fields.values())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"format": 2}, "it states format 2, where 1 is read; diagnose once more"),
        ({"verdict": "sure"}, "verdict: input should be 'named', 'undecided'"),
        ({"further": 1}, "further: extra inputs are not permitted"),
        ({"candidates": [{"name": "x"}]}, "candidates.0.title: field required"),
    ],
)
def test_what_is_none_is_refused_in_a_sentence(document, change, said):
    assert unknown({**deepcopy(document), **change}).startswith(said)


def test_a_document_without_a_format_is_of_another_version(document):
    before = {key: value for key, value in document.items() if key != "format"}
    assert unknown(before).startswith("it states no format, where 1 is read")


def test_a_mistake_of_the_program_names_the_key(document):
    with pytest.raises(ValueError, match="sentence"):
        checked({**document, "sentence": 3})
