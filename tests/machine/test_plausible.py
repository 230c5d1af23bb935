"""Logs that do not belong together are seen before a name is believed."""

import numpy as np
import pytest

from spirob.errors import ConfigError
from spirob.machine.diagnosis import diagnose
from spirob.machine.inverse import InverseProblem
from spirob.machine.plausible import strangers
from spirob.machine.recording import prepare
from spirob.machine.rig import RigFile
from spirob.machine.scaling import Sizes
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")


def problem(*signs):
    """Logs of one axis, whose effort has the wrong sign where `signs` says -1."""
    rig, logs = RigFile.model_validate(description()), []
    for k, sign in enumerate(signs):
        t = np.arange(0, 6, 2e-3)
        w = 4.0 + k
        effort = 0.01 * -(w**2) * np.sin(w * t) + 0.3 * w * np.cos(w * t)
        made = {"t": t, "q": np.sin(w * t), "u": sign * effort}
        logs.append(prepare(f"log{k}", made, rig))
    return InverseProblem(rig, None, logs, [], SIZES, 0.02)


@pytest.mark.parametrize(("signs", "strange"), [((1, 1, 1), ""), ((1, -1, 1), "log1")])
def test_a_log_of_another_motor_is_named(signs, strange):
    made = problem(*signs)
    said = strangers([made], [made({"rig.inertia": 0.01, "rig.viscous": 0.3})])
    assert said.partition(":")[0] == strange


def test_a_log_is_fitted_or_held_out(tmp_path):
    text = "name: a\ntime: {column: t, unit: s}\nposition: {column: q, unit: rad}\n"
    text += "effort: {column: u, unit: N·m, kind: torque}\n"
    (tmp_path / "rig.yaml").write_text(text)
    with pytest.raises(ConfigError, match=r"a\.csv: given twice"):
        diagnose(tmp_path / "rig.yaml", ["a.csv"], ["./a.csv"])
