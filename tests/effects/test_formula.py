"""What need not come to an end is no kernel: it is refused before it runs, with its line."""

import importlib
import inspect
import pkgutil

import pytest

from spirob.effects import Effect, all_effects, load_file
from spirob.effects.check import check
from spirob.effects.formula import open_end
from spirob.errors import EffectError
from spirob.machine import laws
from tests.effects.test_broken import Sound, with_kernel
from tests.effects.test_declaration import GOOD

KERNEL = "        return -torque * speed\n"
LINE = 1 + GOOD[: GOOD.index(KERNEL)].count("\n")
ABOVE = """\
import itertools
import math
import numpy as np
from numba import njit

def endless(speed):
    while speed > 3e4:
        speed += 1.0
    return speed

def twice(speed):
    return 2.0 * speed

def again(speed):
    return again(speed - 1.0) if speed > 3e4 else speed

"""


def written(folder, body, above=ABOVE):
    """A file of one's own whose kernel holds these lines."""
    text = "".join(f"        {line}\n" for line in body)
    (folder / "own.py").write_text(above + GOOD.replace(KERNEL, text))
    return folder / "own.py"


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        (["while speed > 3e4:", "    torque += 1.0", "return torque"], "30000.0` may never end"),
        (["for k in range(int(speed)):", "    torque += k", "return torque"], "may never end"),
        (["for k in itertools.count():", "    torque += k", "return torque"], "may never end"),
        (["for k in range(10**9):", "    torque += k", "return torque"], "may never end"),
        (["for k in range(1001):", "    torque += k", "return torque"], "has 1001 turns, 1000"),
        (
            ["for k in range(50):", "    for j in range(50):", "        torque += j", "return k"],
            "has 2500 turns",
        ),
        (["return sum(k for k in range(int(speed)))"], "`sum.*`"),
        (["return torque * (lambda: speed)()"], "`lambda"),
        (["return np.arange(int(speed)).sum()"], "`np.arange.*nothing that a kernel can call"),
        (["table = [0.0] * int(speed)", "return torque"], r"`\[0\.0\]`"),
        (["return math.factorial(int(speed))"], "nothing that a kernel can call"),
        (["return eval('9**9**9')"], "`eval` is nothing"),
        (["return njit(endless)(speed)"], "nothing that a kernel can call"),
        (["return endless(speed)"], "line 7: `while"),
        (["return again(speed)"], "line 15: `again` calls itself"),
    ],
)
def test_what_may_never_end_is_refused_before_it_runs(tmp_path, body, sentence):
    with pytest.raises(EffectError, match=rf"own\.py': line \d+: .*{sentence}"):
        load_file(written(tmp_path, body))


def test_the_line_is_that_of_the_file(tmp_path):
    with pytest.raises(EffectError, match=rf"line {LINE + 1}: `while"):
        load_file(written(tmp_path, ["torque += 1.0", "while True:", "    pass"], above=""))


@pytest.mark.parametrize(
    "body",
    [
        ["for k in range(1, 9, 2):", "    torque += k / (1.0 + speed * speed)", "return torque"],
        ["for k in (1.0, 3.0):", "    torque += math.sin(k * speed)", "return torque"],
        ["return np.interp(speed, np.array([0.0, 1.0]), np.array([0.0, torque]))"],
        ["return np.tanh(speed) * max(abs(torque), float(int(speed)))"],
        ["if speed > 1.0:", "    raise ValueError('no')", "return twice(speed)"],
    ],
)
def test_a_formula_of_any_kind_is_taken(tmp_path, body):
    assert load_file(written(tmp_path, body))


def test_a_marked_kernel_is_refused(tmp_path):
    marked = GOOD.replace("    @staticmethod\n", "    @staticmethod\n    @njit\n")
    (tmp_path / "own.py").write_text(ABOVE + marked)
    with pytest.raises(EffectError, match=r"own\.py'"):
        load_file(tmp_path / "own.py")


def test_every_effect_and_law_of_the_library_ends():
    modules = [
        importlib.import_module(i.name)
        for i in pkgutil.walk_packages(laws.__path__, f"{laws.__name__}.")
    ]
    classes = [c for m in modules for _, c in inspect.getmembers(m, inspect.isclass)]
    kernels = [c.kernel for c in classes if issubclass(c, Effect) and c is not Effect]
    kernels += [effect.kernel for effect in all_effects().values()]
    assert len(kernels) > len(all_effects())
    assert not [said for kernel in kernels if (said := open_end(kernel))]


def test_an_equation_of_huge_whole_numbers_ends():
    """They count as numbers of a machine do, so that a power of powers overflows at once."""
    broken = with_kernel(Sound.kernel, equation="-T*tanh(speed/rest_speed) + 0*9**9**9")
    assert any(finding.law == "equation" for finding in check(broken))
