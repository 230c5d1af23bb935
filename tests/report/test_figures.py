"""What the page draws is what was measured, to far less than a pixel."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spirob.report.figures import pack, stride, unpack


@given(st.lists(st.floats(-1e4, 1e4), min_size=1, max_size=50), st.booleans())
def test_a_signal_comes_back_within_half_a_step(values, coarse):
    signal = np.array(values)
    packed = pack(signal, coarse)
    assert np.abs(unpack(packed) - signal).max() <= 0.51 * packed["step"]


@pytest.mark.parametrize("coarse", [False, True])
def test_missing_samples_stay_missing(coarse):
    signal = np.array([np.nan, 1.0, 2.0, np.inf])
    back = unpack(pack(signal, coarse))
    np.testing.assert_array_equal(np.isnan(back), [True, False, False, True])


def test_a_coarse_signal_takes_half_the_room():
    signal = np.sin(np.arange(3000))
    assert len(pack(signal, coarse=True)["data"]) == len(pack(signal)["data"]) / 2


def test_a_signal_of_nothing_is_not_packed():
    assert pack(np.full(3, np.nan)) is None


@given(st.integers(1, 10000), st.integers(1, 3000))
def test_a_stride_keeps_no_more_than_asked(samples, most):
    assert len(range(0, samples, stride(samples, most))) <= most
