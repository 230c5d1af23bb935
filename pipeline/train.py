"""Stage `train`: the stacked regressors that tell an object's size from its wrap."""

from pathlib import Path

from pipeline.features import features_of
from pipeline.schema import Config
from pipeline.stage import public_config, run, tell
from spirob.perceive.interval import calibrated
from spirob.perceive.model_file import save_model
from spirob.perceive.size import SizeSettings, train


def stage(root: Path) -> None:
    """Train on the simulated wraps."""
    config = public_config(root)
    settings = stack(config)
    table = features_of(root, "train")
    model = train(table, settings, config.perceive.predictor)
    if table["diameter"].nunique() >= 4:  # fewer leave nothing to hold out
        model = calibrated(model, table)
    save_model(model, root / "data/models/size.joblib")
    tell(f"trained on {len(model.out_of_fold)} wraps; ridge weighs {model.weight:.2f}")


def stack(config: Config) -> SizeSettings:
    """The numbers of the stack; raises ConfigError on an unknown one or a bad value."""
    given = {"seed": config.perceive.seed} | config.perceive.size
    settings = SizeSettings.from_mapping(given)
    assert isinstance(settings, SizeSettings)
    return settings


if __name__ == "__main__":
    run("train", stage)
