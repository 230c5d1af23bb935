"""A model comes back as it was; nothing in a file is run, whatever hash lies beside it."""

import hashlib
import io
import json
import os
import pickle
import zipfile

import numpy as np
import pytest

from spirob.errors import DataError
from spirob.perceive.model_file import hash_file, load_model, save_model
from spirob.perceive.size import BASES, PREDICTORS, predict, train


class Bomb:
    def __reduce__(self):
        return (os.mkdir, (self.path,))

    def __init__(self, path):
        self.path = path


def dumped(value):
    from skops.io import dumps  # slow to import: it looks through all of scikit-learn

    return dumps(value)


@pytest.fixture(scope="module")
def model(known):
    return train(known)


@pytest.fixture
def saved(model, tmp_path):
    digest = save_model(model, tmp_path / "models" / "size.skops")
    return model, tmp_path / "models" / "size.skops", digest


@pytest.mark.parametrize("predictor", [*PREDICTORS, *BASES])
def test_a_saved_model_predicts_the_same_bits(saved, known, predictor):
    model, path, digest = saved
    told = predict(model, known, predictor)
    assert np.array_equal(predict(load_model(path), known, predictor), told)
    assert np.array_equal(predict(load_model(path, digest), known, predictor), told)
    assert hash_file(path).read_text() == f"{digest}  size.skops\n"


def test_all_that_is_known_of_it_comes_back(saved):
    model, path, _ = saved
    back = load_model(path)
    for name in ("features", "predictor", "weight", "settings", "sizes"):
        assert getattr(back, name) == getattr(model, name)
    for name in ("low", "high", "out_of_fold", "errors"):
        assert np.array_equal(getattr(back, name), getattr(model, name))


def test_a_model_trained_again_has_the_same_bytes(saved, known, tmp_path):
    """Else every stage that reads it would run again."""
    *_, digest = saved
    assert save_model(train(known), tmp_path / "again" / "size.skops") == digest


def test_a_changed_file_is_refused(saved):
    _, path, _ = saved
    path.write_bytes(path.read_bytes() + b"x")
    with pytest.raises(DataError, match="was changed and is not loaded"):
        load_model(path)


def hashed(path, content):
    """The content in the file, with a hash that is right beside it."""
    path.write_bytes(content)
    hash_file(path).write_text(hashlib.sha256(content).hexdigest())
    return path


def test_a_pickle_with_a_right_hash_is_not_run(saved, tmp_path):
    _, path, _ = saved
    hashed(path, pickle.dumps(Bomb(str(tmp_path / "exploded"))))
    with pytest.raises(DataError, match="not a model of this program"):
        load_model(path)
    assert not (tmp_path / "exploded").exists()


def test_a_class_or_a_function_that_is_not_listed_is_not_made(saved, tmp_path):
    _, path, _ = saved
    for other in (Bomb(str(tmp_path / "exploded")), os.mkdir):
        hashed(path, dumped({"model": other}))
        with pytest.raises(DataError, match="names what no size model has"):
            load_model(path)
    assert not (tmp_path / "exploded").exists()


def changed(content, change):
    """The file with every part as `change(name, bytes)` leaves it."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as given, zipfile.ZipFile(out, "w") as written:
        for name in given.namelist():
            written.writestr(name, change(name, given.read(name)), zipfile.ZIP_DEFLATED)
    return out.getvalue()


def test_a_damaged_file_is_a_sentence(saved):
    """Arrays cut, replaced by too many zeros, or a schema that is another's."""
    _, path, _ = saved
    whole = path.read_bytes()
    damages = {
        "damaged": lambda name, part: part if name.endswith("json") else part[:40],
        "unpacks to more than": lambda name, part: bytes(1 << 20) if name[0] in "123" else part,
        "holds a ": lambda name, part: json.dumps(schema) if name.endswith("json") else part,
    }
    with zipfile.ZipFile(io.BytesIO(dumped([1, 2]))) as plain:
        schema = json.loads(plain.read("schema.json"))
    for said, damage in damages.items():
        hashed(path, changed(whole, damage))
        with pytest.raises(DataError, match=said):
            load_model(path)


def test_a_tree_that_leads_out_of_itself_is_refused(saved):
    model, path, _ = saved
    model.meta["paper"].estimators_[0, 0].tree_.children_left[0] = 10_000
    save_model(model, path)
    with pytest.raises(DataError, match="links lead nowhere"):
        load_model(path)


def test_a_hash_from_elsewhere_outranks_the_one_beside_the_file(saved):
    _, path, _ = saved
    with pytest.raises(DataError, match="000000000000… is expected"):
        load_model(path, "0" * 64)


def test_missing_and_foreign_files_are_told(saved, tmp_path):
    _, path, _ = saved
    with pytest.raises(DataError, match="cannot be read"):
        load_model(tmp_path / "nothing.skops")
    hash_file(path).write_text("no hash\n")
    with pytest.raises(DataError, match="holds no SHA-256"):
        load_model(path)
