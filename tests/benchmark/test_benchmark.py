"""The benchmark runs and writes what it measured; how fast is never asserted."""

import json
import math
import shutil
from types import SimpleNamespace

import pytest

from spirob.benchmark import MEASURES, diagnosis, identification
from spirob.cli.main import main
from spirob.errors import ConfigError

KEYS = {
    "coupled_tick": ["coupled_tick_over_bare_steps", "robot_seconds_per_second"],
    "threads": ["two_threads_over_one"],
    "decoding": ["decode_samples_per_second"],
    "identification": [
        "identify_speedup_over_mujoco_sysid",
        "identify_error",
        "mujoco_sysid_error",
    ],
    "screening": ["screen_seconds", "screened_effects", "screened_place"],
    "diagnosis": ["diagnosis_seconds_10k", "diagnosis_core_seconds_100k", "diagnosis_named"],
    "feedforward": ["compensate_microseconds", "compensate_microseconds_all"],
}


@pytest.mark.parametrize("name", MEASURES)
def test_a_tiny_run_writes_its_figures(name, tmp_path, monkeypatch):
    """Of fewer rows than a tiny run has for its longest logs, and of two trials for eight."""
    monkeypatch.setattr(diagnosis, "ROWS", dict.fromkeys(diagnosis.ROWS, diagnosis.LEAST))
    monkeypatch.setattr(diagnosis, "DEPTHS", diagnosis.DEPTHS[:1])
    if name == "identification":
        pytest.importorskip("mujoco.sysid", exc_type=ImportError)
    if name == "feedforward" and not any(map(shutil.which, ("cc", "gcc", "clang"))):
        pytest.skip("no C compiler is installed here")
    path = tmp_path / "figures.json"
    assert main(["benchmark", "--tiny", "--only", name, "--json", str(path)]) == 0
    figures = json.loads(path.read_text())
    for key in KEYS[name]:
        assert math.isfinite(figures[key])
        assert figures[key] > 0.0
    if name == "coupled_tick":  # the bare steps play the same trial
        assert figures["bare_steps_apart_rad"] < 1e-3


def test_without_the_extra_the_comparison_is_refused_in_a_sentence(monkeypatch):
    monkeypatch.setattr(identification, "import_module", lambda name: SimpleNamespace())
    with pytest.raises(ConfigError, match=r"needs mujoco\.sysid"):
        identification.fit_by_mujoco(None, [], [])
