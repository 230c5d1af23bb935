"""`spirob predict`: a size with its interval, or a sentence."""

import numpy as np
import pytest

from spirob.cli.main import main
from spirob.emulator import EmulatedRobot
from spirob.perceive.features import table
from spirob.perceive.interval import calibrated
from spirob.perceive.model_file import save_model
from spirob.perceive.size import train
from spirob.plant import Plant, Rig
from spirob.trials import Trial, record
from spirob.trials.simulation import simulate
from spirob.trials.trial import wrap_trial


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A model trained in simulation, and two logs of the emulated robot: a wrap and a bend."""
    folder = tmp_path_factory.mktemp("predict")
    plant, rng = Plant(Rig()), np.random.default_rng(0)
    sizes = [0.02, 0.03, 0.04, 0.05, 0.06]
    plain = [wrap_trial(f"w{k}", "train", s, {}, rng) for k, s in enumerate(sorted(sizes * 2))]
    changes = {"motor.rotor_damping": 5e-5}
    known = table([simulate(plant, Trial.from_plain(p), changes) for p in plain])
    save_model(calibrated(train(known), known), folder / "size.skops")
    still = wrap_trial("still", "heldout", 0.04, {"speed": 0.001, "duration": 1.5}, rng)
    for given in (wrap_trial("wrap", "heldout", 0.04, {}, rng), still):
        trial, robot = Trial.from_plain(given), EmulatedRobot(seed=2)
        record(
            trial,
            robot,
            folder / f"{trial.name}.mcap",
            Rig(),
        )
        robot.close()
    return folder


def predict(folder, *arguments):
    return main(["predict", *map(str, arguments), "--model", str(folder / "size.skops")])


def test_a_wrap_has_a_size_and_an_interval(folder, capsys):
    assert predict(folder, folder / "wrap.mcap", "--confidence", "0.75") == 0
    said = capsys.readouterr().out
    size = float(said.split(": ")[1].split(" mm")[0])
    low, high = map(float, said.split("interval ")[1].removesuffix(" mm\n").split(" to "))
    assert low < size < high
    assert abs(size - 40) < 12
    assert "75 % interval" in said


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["still.mcap"], "so nothing was wrapped"),
        (["nowhere.mcap"], "nowhere.mcap"),
        (["wrap.mcap", "--confidence", "0.999"], "support a confidence"),
        (["wrap.mcap", "--motor", "right"], "right tendon"),
    ],
)
def test_anything_else_is_one_sentence(folder, capsys, arguments, said):
    first, *more = arguments
    assert predict(folder, folder / first, *more) == 2
    spoken = capsys.readouterr().err
    assert said in spoken
    assert len(spoken.strip().splitlines()) == 1


def test_a_model_that_was_changed_is_not_loaded(folder, tmp_path, capsys):
    (tmp_path / "size.skops").write_bytes((folder / "size.skops").read_bytes() + b"x")
    (tmp_path / "size.skops.sha256").write_text((folder / "size.skops.sha256").read_text())
    assert predict(tmp_path, folder / "wrap.mcap") == 2
    assert "was changed and is not loaded" in capsys.readouterr().err
