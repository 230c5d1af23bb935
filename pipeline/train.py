"""Stage `train`: the stacked regressors that tell an object's size from its wrap."""

from pathlib import Path

import pandas as pd

from pipeline.features import features_of
from pipeline.schema import Config
from pipeline.stage import entry, public_config, tell, workers, write_json
from spirob.perceive.interval import calibrated
from spirob.perceive.model_file import save_model
from spirob.perceive.size import SizeModel, SizeSettings, train
from spirob.perceive.study import chosen

CHOICE = Path("data/models/choice.json")


def stage(root: Path) -> None:
    """Train on the simulated wraps."""
    config = public_config(root)
    table = features_of(root, "train")
    model, tried = learnt(table, config)
    if table["diameter"].nunique() >= 4:  # fewer leave nothing to hold out
        model = calibrated(model, table, workers())
    save_model(model, root / "data/models/size.skops")
    write_json(root / CHOICE, {"tried": tried})
    tell(f"trained on {len(model.out_of_fold)} wraps; ridge weighs {model.weight:.2f}")


def learnt(table: pd.DataFrame, config: Config) -> tuple[SizeModel, list[dict[str, float]]]:
    """A stack trained on features, with the numbers that these choose, and what was tried.

    Raises ConfigError on an unknown number or a bad value, DataError on a bad table.
    """
    given = {"seed": config.perceive.seed} | config.perceive.size
    settings = SizeSettings.from_mapping(given)
    assert isinstance(settings, SizeSettings)
    settings, tried = chosen(table, settings, config.perceive.choose, workers())
    if tried:
        best = min(tried, key=lambda one: one["mae"])
        tell(f"chosen of {len(tried)} by the out-of-fold error: {_told(best)}")
    return train(table, settings, config.perceive.predictor), tried


def _told(one: dict[str, float]) -> str:
    numbers = ", ".join(f"{name} {value:g}" for name, value in one.items() if name != "mae")
    return f"{numbers} ({one['mae']:.2f} mm)"


if __name__ == "__main__":
    entry("train", stage, __doc__)
