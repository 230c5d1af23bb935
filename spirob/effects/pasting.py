"""Kernels of effects as text: pasted into the loops that the program generates, and called there.

Numba's disk cache does not notice a change in an imported function, but it does notice a new file;
so what a loop needs is in its own source, and its file is named by a hash of that
(`spirob.generated`).
"""

import inspect
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping

from spirob.effects.effect import Effect

# only what is compiled with it calls it: no entry for Python, nothing of its own on disk
CALLED = "no_cpython_wrapper=True, no_cfunc_wrapper=True"
MARKED = f"@njit({CALLED})\n"
ENTRY = "@njit(cache=True)\n"


def pasted(functions: Iterable[Callable[..., object]], mark: str = MARKED) -> list[str]:
    """The text of compiled functions under their own names."""
    return [mark + text(f, f.__name__) for f in functions]


def kernels(effects: Iterable[type[Effect]]) -> list[str]:
    """The text of compiled kernels under the names by which `call` calls them."""
    return [MARKED + text(e.kernel, f"kernel_{e.name()}") for e in effects]


def call(
    effect: type[Effect],
    upstream: str,
    dt: str,
    reads: Mapping[str, str],
    states: Mapping[str, str],
    numbers: Mapping[str, str],
) -> str:
    """The expression that calls an effect's kernel, of the expressions that it is given.

    reads  of its signals by name, at least those that it reads;  states, numbers  by its own names
    """
    places = {"upstream": upstream, "dt": dt, **states, **numbers}
    places |= {argument: reads[signal] for argument, signal in effect.reads.items()}
    return f"kernel_{effect.name()}({', '.join(places[a] for a in effect.arguments())})"


def text(function: Callable[..., object], name: str) -> str:
    """The text of a function, under another name and without its decorators."""
    source = textwrap.dedent(inspect.getsource(function)).replace("@staticmethod\n", "")
    return re.sub(r"def \w+\(", f"def {name}(", source, count=1)
