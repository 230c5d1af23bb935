"""One log under several names is found by its rows."""

import numpy as np
import pytest

from spirob.errors import ConfigError
from spirob.machine.selection import each_once

COLUMNS = ["q", "u"]


def log(seed, rows=500):
    rng = np.random.default_rng(seed)
    q, u = rng.normal(size=(2, rows))
    return {"t": np.arange(rows) * 0.01, "q": q, "u": u}


def test_logs_of_their_own_pass():
    each_once([("a", log(1)), ("b", log(2)), ("c", log(3, 100))], COLUMNS)


def test_a_copy_is_found_even_with_another_clock():
    copy = log(1) | {"t": log(1)["t"] + 7.0, "more": np.zeros(500)}
    with pytest.raises(ConfigError, match="b: holds the rows of a; a log is fitted or held out"):
        each_once([("a", log(1)), ("b", copy)], COLUMNS)


@pytest.mark.parametrize("part", [slice(0, 100), slice(200, 400), slice(499, 500)])
def test_a_stretch_of_another_log_is_found_in_any_order(part):
    cut = {name: values[part] for name, values in log(1).items()}
    for logs in ([("a", log(1)), ("b", cut)], [("b", cut), ("a", log(1))]):
        if len(cut["q"]) == 1:  # a single row says nothing of a motion
            each_once(logs, COLUMNS)
            continue
        with pytest.raises(ConfigError, match="b: is a part of a"):
            each_once(logs, COLUMNS)


def test_what_stands_or_lacks_a_column_is_judged_elsewhere():
    still = {"q": np.zeros(50), "u": np.zeros(50)}
    each_once([("a", still), ("b", still), ("c", {"q": np.arange(9.0)})], COLUMNS)
