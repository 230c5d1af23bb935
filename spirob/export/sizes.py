"""How large the effects of a model are on its held-out logs: what leaving one out costs."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from spirob.export.code import python_text
from spirob.export.corrected import Corrected, Held
from spirob.export.heldout import Heldout, there


def left_out(model: Corrected, one: Held) -> str:
    """The error of leaving an effect out, in words."""
    if not there(model.folder):
        return "of unknown size, as the diagnosis has no held-out logs beside it"
    heldout = Heldout(model)
    whole = effort_of(model, heldout)
    less = effort_of(
        replace(model, effects=tuple(e for e in model.effects if e is not one)), heldout
    )
    used = heldout.table["used"].to_numpy(bool)
    missing = float(np.sqrt(np.mean((whole - less)[used] ** 2)))
    size = float(np.sqrt(np.mean(heldout.table["effort"].to_numpy(float)[used] ** 2)))
    return f"costs {missing:.3g} {model.effort} RMS, {missing / size:.2%} of the effort"


def effort_of(model: Corrected, heldout: Heldout) -> np.ndarray:
    """The effort that a model asks for along the held-out logs, as they are logged, (n,)."""
    given, names = heldout.given(), dict[str, Any]()
    exec(compile(python_text(model), "exported", "exec"), names)  # of checked arithmetic alone
    state, n = names["State"](), len(given["position"])
    effort, framed = np.zeros(n), np.zeros(n)
    fed = {"carried": "carried", "payload": "payload", "offset": "offset"}
    fed |= {"weight_x": "along", "weight_y": "across"}
    rows = [given[name].tolist() for name in ("position", "speed", "acceleration", "effort")]
    for k, dt in enumerate(heldout.steps.tolist()):
        inside = range(heldout.starts[k], heldout.starts[k + 1])
        state.reset()
        state.time = float(given["time"][inside[0]])
        for row in inside:
            for field, column in fed.items():
                setattr(state, field, float(given[column][row]))
            q, v, a, _ = (x[row] for x in rows)
            effort[row] = names["compensate"](state, q, v, a, dt)
        for out, function, values in (
            (effort, names["reported"], effort.tolist()),
            (framed, names["framed"], rows[3]),
        ):
            _through(function, state, out, values, inside, dt)
    return effort + given["effort"] - framed


def _through(
    function: Callable[..., float],
    state: Any,
    out: np.ndarray,
    values: list[float],
    rows: range,
    dt: float,
) -> None:
    state.reset()
    for row in rows:
        out[row] = function(state, values[row], dt)
