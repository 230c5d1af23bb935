"""What runs apart may die without taking this process along."""

import os

import pytest

from spirob.logs.foreign.apart import Crashed, apart


def test_the_answer_comes_back():
    assert apart(divmod, 17, 5) == (3, 2)


def test_an_error_comes_back_as_one():
    with pytest.raises(ValueError, match="invalid literal"):
        apart(int, "x")


def test_a_crash_is_an_error_too():
    with pytest.raises(Crashed, match="brings the reader down"):
        apart(os.abort)
