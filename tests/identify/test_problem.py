"""The numbers fitted by default are the same with and without the pipeline's configuration."""

from pathlib import Path

import yaml

from spirob.identify.problem import FITTED
from spirob.plant import Plant, Rig

CONFIG = Path(__file__).parents[2] / "conf/identify/default.yaml"


def test_the_configuration_and_the_library_fit_the_same_numbers():
    assert tuple(yaml.safe_load(CONFIG.read_text())["parameters"]) == FITTED


def test_the_model_has_them_all():
    assert set(FITTED) <= set(Plant(Rig()).table.names)
