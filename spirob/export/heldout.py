"""The held-out logs of a diagnosis, and what a model that is played elsewhere makes of them.

Scripts play what was exported, each in a process that cannot import this project.  `left_out` says
how large an effect of the model is on them: what leaving it out costs.
"""

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from spirob.errors import ExportError
from spirob.export.code import python_text
from spirob.export.corrected import Corrected, Held
from spirob.logs.trace import read_table
from spirob.machine.motion import Motion, late
from spirob.machine.recording import Recording

PLAYERS = Path(__file__).parent / "players"
ALONE = (
    "import runpy, sys; sys.modules['spirob'] = sys.modules['pipeline'] = None; "
    "sys.argv = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"
)
LONGEST = 3600  # s


def played_alone(
    player: str, folder: Path, about: dict[str, Any], given: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """What a player makes of logs in what was exported to a folder, arrays by name.

    Raises ExportError, with what the player says, where it cannot be played.
    """
    with tempfile.TemporaryDirectory() as place:
        kept, result = Path(place) / "given.npz", Path(place) / "result.npz"
        np.savez(kept, about=json.dumps(about), **given)  # type: ignore[arg-type]
        alone(PLAYERS / "alone.py", player, folder.resolve(), kept, result)
        with np.load(result) as made:
            return dict(made)


def alone(script: Path, *arguments: Path | str) -> None:
    """Run a script that cannot import this project; raises ExportError with what it says."""
    command = [sys.executable, "-I", "-c", ALONE, str(script), *map(str, arguments)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        raise ExportError(f"the exported model did not end within {LONGEST} s") from None
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["nothing"])[-1]
        raise ExportError(f"the exported model cannot be played: {said[:200]}")


FILE = "heldout.parquet"
COLUMNS = (
    "time", "position", "speed", "acceleration", "effort", "carried", "payload", "offset",
    "along", "across",
)  # fmt: skip


@dataclass(frozen=True)
class Errors:
    """RMS over the held-out rows, in the unit of the effort.

    ours, exported  model less measurement, of the model here and of the exported one
    apart           the one less the other;  size  of what the effects do together
    """

    ours: float
    exported: float
    apart: float
    size: float

    @property
    def lost(self) -> float:
        """What the export loses, as a share of the effects' size; of the effort without any."""
        return self.apart / self.size if self.size > 0.0 else np.inf * self.apart


class Heldout:
    """The rows of the held-out logs.

    starts (pieces + 1,), steps (pieces,)  where pieces begin, and their sample periods [s]
    """

    def __init__(self, model: Corrected):
        path = model.folder / FILE
        try:
            self.table = read_table(path)
        except (OSError, ValueError) as error:
            why = " ".join(str(error).split())[:100]
            raise ExportError(f"{path}: cannot be read ({why}); diagnose again") from None
        needed = {"trial", "piece", "used", "modelled", "without", *COLUMNS}
        if missing := sorted(needed - set(self.table.columns)):
            raise ExportError(f"{path}: has no column '{missing[0]}'; diagnose again")
        self.model = model
        own = self.table[["trial", "piece"]].to_numpy()
        cuts = np.flatnonzero(np.any(np.diff(own, axis=0) != 0, axis=1)) + 1
        self.starts = np.array([0, *cuts, len(own)])
        self._trials = own[self.starts[:-1], 0]
        try:
            self.steps = np.array([float(model.trials[k]["period"]) for k in self._trials])
        except (IndexError, KeyError, TypeError, ValueError):
            raise ExportError(f"{path}: belongs to another diagnosis; diagnose again") from None

    def given(self) -> dict[str, np.ndarray]:
        """What a player needs."""
        kept = [str(n) for n in self.table.columns if n not in ("used", "trial")]
        found = {name: self.table[name].to_numpy(float) for name in kept}
        numbers, q = self.model.numbers, found["position"]
        turned = q if self.model.axis == "rad" else np.zeros_like(q)
        weight = numbers["payload_cosine"] * np.cos(turned)
        weight += numbers["payload_sine"] * np.sin(turned)
        one = numbers["payload_inertia"] * found["acceleration"] + weight
        found["hung"] = found["offset"] + found["payload"] * one
        usual = self.model.usual
        hung = usual["offset"] + (0.0 if self.model.body else usual["payload"] * one)
        return found | {
            "beside": found["hung"] - hung,  # of what goes with the exported body
            "starts": self.starts,
            "steps": self.steps,
        }

    def errors(self, effort: np.ndarray, framed: np.ndarray) -> Errors:
        """How far a played effort is from the measurement, and from the model here.

        effort  as reported, before the delay between motion and log, (n,)
        framed  the measured effort as late as the frame of a bus brings it, (n,)
        """
        table = self.table
        measured = table["effort"].to_numpy(float)
        played = late(effort, self.model.numbers["delay"], self._motion()) + measured - framed
        ours, bare = (table[n].to_numpy(float) for n in ("modelled", "without"))
        used = table["used"].to_numpy(bool)

        def rms(values: np.ndarray) -> float:
            return float(np.sqrt(np.mean(self._last(values)[used] ** 2)))

        return Errors(
            rms(ours - measured),
            rms(played - measured),
            rms(played - ours),
            rms(ours - bare) if self.model.effects else rms(measured),
        )

    def _motion(self) -> Motion:
        none = np.zeros(len(self.table))
        return Motion(self.starts, self.steps, none, none, none, none, none, {})

    def _last(self, values: np.ndarray) -> np.ndarray:
        """The filter that measured and modelled effort pass."""
        out = np.empty_like(values)
        for k, trial in enumerate(self._trials):
            about = self.model.trials[trial]
            rows = slice(self.starts[k], self.starts[k + 1])
            filters = Recording("", about["period"], about["cutoff"], about["every"], [], [])
            out[rows] = filters.last(values[rows])
        return out


def there(folder: Path) -> bool:
    """Whether a diagnosis has its held-out logs beside it."""
    return (folder / FILE).is_file()


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
