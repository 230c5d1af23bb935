"""A model comes back as it was, and a file that differs is not even opened as a pickle."""

import hashlib
import os
import pickle

import numpy as np
import pytest

from spirob.errors import DataError
from spirob.perceive.model_file import hash_file, load_model, save_model
from spirob.perceive.size import predict, train


class Bomb:
    def __reduce__(self):
        return (os.mkdir, (self.path,))

    def __init__(self, path):
        self.path = path


@pytest.fixture
def saved(known, tmp_path):
    model = train(known)
    digest = save_model(model, tmp_path / "models" / "size.joblib")
    return model, tmp_path / "models" / "size.joblib", digest


def test_a_saved_model_predicts_the_same_bits(saved, known):
    model, path, digest = saved
    assert np.array_equal(predict(load_model(path), known), predict(model, known))
    assert np.array_equal(predict(load_model(path, digest), known), predict(model, known))
    assert hash_file(path).read_text() == f"{digest}  size.joblib\n"


def test_a_changed_file_is_refused_before_anything_in_it_runs(saved, tmp_path):
    _, path, _ = saved
    path.write_bytes(pickle.dumps(Bomb(str(tmp_path / "exploded"))))
    with pytest.raises(DataError, match="was changed and is not loaded"):
        load_model(path)
    assert not (tmp_path / "exploded").exists()


def test_a_hash_from_elsewhere_outranks_the_one_beside_the_file(saved):
    _, path, _ = saved
    with pytest.raises(DataError, match="000000000000… is expected"):
        load_model(path, "0" * 64)


def test_missing_and_foreign_files_are_told(saved, tmp_path):
    _, path, _ = saved
    with pytest.raises(DataError, match="cannot be read"):
        load_model(tmp_path / "nothing.joblib")
    hash_file(path).write_text("no hash\n")
    with pytest.raises(DataError, match="holds no SHA-256"):
        load_model(path)
    path.write_bytes(pickle.dumps([1, 2]))
    hash_file(path).write_text(hashlib.sha256(path.read_bytes()).hexdigest())
    with pytest.raises(DataError, match="holds a list"):
        load_model(path)
