"""Kernels in C do what they do here, for every effect; and what is no kernel is refused."""

import ast
import ctypes
import inspect
import shutil
import subprocess

import numpy as np
import pytest

from spirob.effects import all_effects, replay
from spirob.errors import ExportError
from spirob.export.corrected import Held
from spirob.export.law import kernel_functions, kernel_name, law_of
from spirob.export.translate import HELP, Function
from spirob.machine.laws import AXIS, FRICTION, LEVER, LOAD_SIDE

LAWS = [
    *all_effects().values(),
    *AXIS.values(),
    *LOAD_SIDE.values(),
    *LEVER.values(),
    *FRICTION.values(),
]
COMPILER = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
STRICT = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic", "-shared", "-fPIC"]
SAMPLES, STEP = 400, 1e-3


def held(effect, values=None):
    text = inspect.getsource(inspect.getmodule(effect))
    return Held(law_of(effect.name(), text, effect), dict(values or {}))


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """All kernels as one library."""
    if COMPILER is None:
        pytest.skip("no C compiler is installed here")
    folder = tmp_path_factory.mktemp("kernels")
    parts = ["#include <math.h>", HELP]
    for k, effect in enumerate(LAWS):
        one = held(effect)
        for function in kernel_functions(one):
            text = function.c.replace("static inline double ", f"double law_{k}_", 1)
            parts.append(text)
    (folder / "laws.c").write_text("\n\n".join(parts))
    command = [COMPILER, *STRICT, "-o", str(folder / "laws.so"), str(folder / "laws.c"), "-lm"]
    subprocess.run(command, check=True)
    return ctypes.CDLL(str(folder / "laws.so"))


def in_c(library, k, effect, numbers, inputs):
    """Contributions along the inputs, (SAMPLES,)."""
    call = getattr(library, f"law_{k}_{kernel_name(held(effect))}")
    call.restype = ctypes.c_double
    order, memory = effect.arguments(), list(effect.state)
    call.argtypes = [ctypes.c_double] * len(order)
    call.argtypes += [ctypes.POINTER(ctypes.c_double)] * len(memory)
    values = {**numbers, "dt": STEP, **effect.state}
    out = np.zeros(SAMPLES)
    for row in range(SAMPLES):
        values |= {name: float(column[row]) for name, column in inputs.items()}
        following = [ctypes.c_double() for _ in memory]
        out[row] = call(*(values[a] for a in order), *map(ctypes.byref, following))
        values |= {name: kept.value for name, kept in zip(memory, following, strict=True)}
    return out


@pytest.mark.parametrize(
    "k", range(len(LAWS)), ids=lambda k: LAWS[k].__module__.split("spirob.")[1]
)
def test_a_kernel_in_c_is_the_kernel(k, library):
    effect, rng = LAWS[k], np.random.default_rng(k)
    numbers = {name: about.nominal for name, about in effect.parameters().items()}
    inputs = replay.motion(effect, rng, SAMPLES, STEP)
    inputs = {n: np.broadcast_to(np.asarray(v, float), SAMPLES) for n, v in inputs.items()}
    wanted = replay.run(effect, numbers, inputs, STEP)[0]
    if not inputs:
        wanted = np.full(SAMPLES, wanted[0])
    found = in_c(library, k, effect, numbers, inputs)
    assert np.abs(found - wanted).max() <= 1e-9 * np.abs(wanted).max()
    assert np.abs(wanted).max() > 0.0


@pytest.mark.parametrize(
    "k", range(len(LAWS)), ids=lambda k: LAWS[k].__module__.split("spirob.")[1]
)
def test_a_file_says_what_its_class_declares(k):
    effect = LAWS[k]
    if effect.name() == "feedback_latency":
        pytest.skip("its memory is no literal in its file; the class is asked")
    law = law_of(effect.name(), inspect.getsource(inspect.getmodule(effect)))
    assert (law.port, law.reads, law.state) == (effect.port, effect.reads, effect.state)
    assert (law.neutral, law.numbers) == (effect.neutral, tuple(effect.parameters()))


def function(body, arguments="x, n", known=None):
    node = ast.parse(f"def kernel({arguments}):\n" + "\n".join(f"    {s}" for s in body)).body[0]
    return Function("effect 'strange'", node, known or {})


@pytest.mark.parametrize(
    "body",
    [
        ["return eval('1')"],
        ["return open('/etc/passwd')"],
        ["import os", "return x"],
        ["return x.real"],
        ["return __import__('os').system('true')"],
        ["return (lambda: x)()"],
        ["return [x][0]"],
        ["while x > 0: x -= 1.0", "return x"],
        ["for k in range(n): x += 1.0", "return x"],
        ["for k in range(10000): x += 1.0", "return x"],
        ["return math.gamma(x)"],
        ["return math.sin(x, n)"],
        ["return 'text'"],
        ["return y"],
        ["global x", "return x"],
        ["return x if n else (x, n)"],
        ["return 1e999"],
        ["x[0] = 1.0", "return x"],
        ["if x > 0: return x", "return x, n"],
        ["return max(x)"],
        ["return max(*x)"],
        ["return min(x, key=n)"],
        ["return x @ n"],
        ["return x in n"],
        ["try: pass", "except Exception: pass", "return x"],
        ["def inner(): return x", "return inner()"],
        ["return (y := x)"],
        ["max = x", "return max(x, n)"],
    ],
    ids=lambda body: "; ".join(body)[:40],
)
def test_what_is_no_arithmetic_does_not_leave(body):
    with pytest.raises(
        ExportError, match=r"effect 'strange': its kernel holds .*, which cannot leave"
    ):
        function(body)


@pytest.mark.parametrize("arguments", ["x=open('f'), n=1", "*x", "x, *, n", "x, /, n", "**x"])
def test_arguments_are_plain_names(arguments):
    with pytest.raises(ExportError, match="arguments that are not plain"):
        function(["return 1.0"], arguments)


def test_arithmetic_of_every_kind_is_the_same_in_c(tmp_path):
    if COMPILER is None:
        pytest.skip("no C compiler is installed here")
    body = [
        "a, b = n, x",
        "kept = (a, b, 2 * a, a - b)",
        "k = int(abs(a) * 1.7)",
        "total = 0.0",
        "for turn in range(5):",
        "    total += kept[k] * turn if a < b <= 3 else -total",
        "    if total > 40 and not a == b or turn > 3:",
        "        break",
        "double = max(a, b, total) - min(a, b) ** 2 + a % 0.7 + b // 0.3",
        "return double + math.copysign(math.pi, x) + math.expm1(min(x, 1.0)), +k",
    ]
    one = function(body)
    names = {}
    source = "import math\ndef kernel(x, n):\n" + "\n".join(f"    {s}" for s in body)
    exec(source, names)
    text = one.c.replace("static inline double kernel", "double kernel", 1)
    (tmp_path / "k.c").write_text("\n".join(["#include <math.h>", HELP, text]))
    command = [COMPILER, *STRICT, "-o", str(tmp_path / "k.so"), str(tmp_path / "k.c"), "-lm"]
    subprocess.run(command, check=True)
    kernel = ctypes.CDLL(str(tmp_path / "k.so")).kernel
    kernel.restype = ctypes.c_double
    kernel.argtypes = [ctypes.c_double] * 2 + [ctypes.POINTER(ctypes.c_double)]
    for x, n in np.random.default_rng(0).uniform(-1.7, 1.7, (200, 2)).tolist():
        second = ctypes.c_double()
        first = kernel(x, n, ctypes.byref(second))
        assert (first, second.value) == pytest.approx(names["kernel"](x, n), rel=1e-12, abs=1e-12)
