"""Tables: parameters with intervals and covariance, and a file to draw other machines from."""

import csv
import io
import json
from dataclasses import replace
from typing import TYPE_CHECKING

from spirob.errors import ExportError

if TYPE_CHECKING:
    from spirob.export.arm import CorrectedArm
    from spirob.export.corrected import Corrected, Fitted

HOLDS = "fitted numbers with intervals and covariance: CSV, LaTeX, and what to draw models from"
LACKS = "laws: the draws are put into what `--to mujoco` wrote"
LOSSY = False
WIDTH = 3.92  # of a 95 % interval, in standard deviations
DRAW = '''"""Draws machines as likely as the logs leave them; beside what `--to mujoco` wrote."""

import json

import mujoco
import numpy as np

import {name}

TOLD = json.load(open("randomisation.json", encoding="utf-8"))
SOURCE = mujoco.MjSpec.from_file("{name}.xml")


def draw(rng):
    """A compiled model with other numbers; those of its effects go into the module."""
    drawn = rng.multivariate_normal(TOLD["mean"], TOLD["covariance"])
    numbers = dict(zip(TOLD["names"], np.clip(drawn, TOLD["low"], TOLD["high"])))
{lines}
    return SOURCE.compile()
'''
AXIS = """\
    for full, value in numbers.items():
        setattr({name}, full.removeprefix("rig.").replace(".", "_").upper(), value)
    joint, load = SOURCE.joint("axis"), SOURCE.body("load")
    joint.damping[0], joint.stiffness[0] = {name}.VISCOUS, {name}.STIFFNESS
    {inertia}
    SOURCE.actuator("drive").gainprm[0] = {name}.SCALE"""
INERTIA = {"rad": "load.inertia = [{name}.INERTIA] * 3", "m": "load.mass = {name}.INERTIA"}
ARM = """\
    for full, value in numbers.items():
        {name}.P[{name}.NAMES.index(full)] = value
    arm = dict(zip({name}.NAMES, {name}.P))
    for k, scale in enumerate({name}.STIFFNESS / {name}.STIFFNESS[0]):
        own = arm["arm.base_stiffness"] * scale
        SOURCE.joint(f"hinge_{{k}}").stiffness[0] = own
        SOURCE.joint(f"hinge_{{k}}").damping[0] = own * arm["arm.damping_time"]"""


def files(model: "Corrected") -> dict[str, str]:
    """Name of each file -> its text."""
    from spirob.export.code import c_name

    name = c_name(model.name)
    lines = AXIS.format(name=name, inertia=INERTIA[model.axis].format(name=name))
    if model.body is not None:  # its own numbers stay
        lines = lines.partition("\n    joint, load")[0]
    return _tables(model.fitted, DRAW.format(name=name, lines=lines))


def arm(model: "CorrectedArm") -> dict[str, str]:
    """The same of an arm; numbers whose correlation is not known count as independent."""
    import numpy as np

    from spirob.export.arm import correlation_of
    from spirob.export.code import c_name
    from spirob.export.corrected import Fitted

    plant, told = model.plant(), model.fitted
    names = tuple(n for n in told if n in plant.table.names)
    about = [plant.table.about[n] for n in names]
    fitted = Fitted(
        names,
        tuple(float(told[n]["value"]) for n in names),
        tuple((float(told[n]["low"]), float(told[n]["high"])) for n in names),
        tuple((a.low, a.high) for a in about),
        tuple(str(told[n]["unit"]) for n in names),
        None,
    )
    widths = [(high - low) / WIDTH for low, high in fitted.intervals]
    together = correlation_of(model, names)
    if together is None:
        known = {**model.correlation, **{(n, n): 1.0 for n in names}}
        together = np.array([[known.get((a, b), 0.0) for b in names] for a in names])
    covariance = tuple(map(tuple, (together * np.outer(widths, widths)).tolist()))
    fitted = replace(fitted, covariance=covariance)
    name = c_name(model.name)
    return _tables(fitted, DRAW.format(name=name, lines=ARM.format(name=name)))


def _tables(fitted: "Fitted", draw: str) -> dict[str, str]:
    if not fitted.names:
        raise ExportError("nothing was fitted, so there is no table to write")
    rows = list(
        zip(fitted.names, fitted.values, fitted.intervals, fitted.bounds, fitted.units, strict=True)
    )
    plain = [["name", "value", "low", "high", "bound_low", "bound_high", "unit"]]
    plain += [[n, repr(v), *map(repr, (*i, *b)), u] for n, v, i, b, u in rows]
    covariance = _covariance(fitted)
    square = [["", *fitted.names]]
    square += [[n, *map(repr, row)] for n, row in zip(fitted.names, covariance, strict=True)]
    told = {
        "names": list(fitted.names),
        "units": list(fitted.units),
        "mean": list(fitted.values),
        "covariance": covariance,
        "low": [low for low, _ in fitted.bounds],
        "high": [high for _, high in fitted.bounds],
        "correlations": "fitted" if fitted.covariance else "unknown: taken as independent",
    }
    return {
        "parameters.csv": _csv(plain),
        "covariance.csv": _csv(square),
        "parameters.tex": _latex(rows),
        "randomisation.json": json.dumps(told, indent=2, ensure_ascii=False) + "\n",
        "draw.py": draw,
    }


def _covariance(fitted: "Fitted") -> list[list[float]]:
    if fitted.covariance is not None:
        return [list(row) for row in fitted.covariance]
    widths = [(high - low) / WIDTH for low, high in fitted.intervals]
    n = len(widths)
    return [[widths[i] ** 2 if i == j else 0.0 for j in range(n)] for i in range(n)]


def _csv(rows: list[list[str]]) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()


def _latex(rows: list[tuple[str, float, tuple[float, float], tuple[float, float], str]]) -> str:
    lines = [r"\begin{tabular}{lrll}", r"number & value & 95\,\% interval & unit \\ \hline"]
    for name, value, (low, high), _, unit in rows:
        plain = name.removeprefix("rig.").replace("_", r"\_")
        lines.append(rf"{plain} & {value:.4g} & [{low:.4g}, {high:.4g}] & {_unit(unit)} \\")
    return "\n".join([*lines, r"\end{tabular}"]) + "\n"


def _unit(unit: str) -> str:
    """A unit as LaTeX reads it."""
    raised = {"²": "$^2$", "³": "$^3$", "·": r"$\cdot$", "Ω": r"$\Omega$", "%": r"\%", "_": r"\_"}
    return "".join(raised.get(c, c) for c in unit)
