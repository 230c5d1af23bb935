"""`RIG.yaml` and effects of one's own from disk; a mistake is an error that says where it stands.

A file with an effect is a program.  A description may come from anybody, so it names only files
beside or below itself; any other is given by hand.  Each is tried in a process apart before it is
run here: one that never ends, or ends the program, is told in a sentence.  A kernel that is taken
ends at any numbers (`effects.formula`).
"""

import re
import signal
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from spirob import plain_yaml
from spirob.effects import Effect, all_effects, find_effects, load_file, replay
from spirob.errors import ConfigError, EffectError
from spirob.files import checked, content, inside
from spirob.logs.readers import Crashed, TooLong, apart
from spirob.machine.arm.description import ArmFile
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.kernel_loop import loop_of

LARGEST = 2**18  # bytes of a description
KIND = re.compile(r"function-.*|literal\[.*|float|Column")  # which of several an entry may be


def load_rig(path: Path | str) -> tuple[RigFile | ArmFile, Path]:
    """The description, of a rig or of our arm, and its folder, from which its paths count.

    Raises MissingLog where there is no file, DataError where it is none that can be read, and
    ConfigError with the place of the first mistake.
    """
    given = plain_yaml.read(content(path, "rig description", LARGEST), str(path))
    return described(given, str(path)), Path(path).parent


def described(given: object, where: str) -> RigFile | ArmFile:
    """The description in plain data; raises ConfigError naming `where` and the first mistake."""
    if not isinstance(given, Mapping):
        raise ConfigError(f"{where}: a rig is a mapping of keys, got {type(given).__name__}")
    kind: type[RigFile] | type[ArmFile] = ArmFile if given.get("body") == "arm" else RigFile
    try:
        return kind.model_validate(dict(given))
    except ValidationError as error:
        raise ConfigError(f"{where}: {_first(error)}") from error


def _first(error: ValidationError) -> str:
    wrong = error.errors()[0]
    place = ".".join(part for part in map(str, wrong["loc"]) if not KIND.fullmatch(part))
    said = wrong["msg"].removeprefix("Value error, ")
    if wrong["type"] == "model_type":
        said = "a mapping of keys is needed"
    if wrong["type"] in ("extra_forbidden", "unexpected_keyword_argument"):  # of a record
        said = "no such key; docs/rig_keys.md lists all"
    more = error.error_count() - 1
    return f"{place + ': ' if place else ''}{said}" + (f" (and {more} more)" if more else "")


LONGEST = 15.0  # s of computing: an import and a compilation take two or three
WAITED = 2.0  # times that by the clock, on a busy machine
STEP, SAMPLES = 1e-3, 100  # s, and how many of them
BEYOND = 1e3  # times the declared span, as far as the signals of any machine go


def files(names: Sequence[str], folder: Path, given: Sequence[Path | str] = ()) -> list[str]:
    """Names as they are found: of effects of the library, and paths of files.

    names  in a description in `folder`;  given  by hand, with paths from where the program runs
    """
    if isinstance(given, str | Path) or not isinstance(given, Sequence):
        one = "a single one" if isinstance(given, str | Path) else type(given).__name__
        raise ConfigError(f"effects: a list of names and files, got {one}")
    try:
        own = [str(inside(n, folder, "effects")) if n.endswith(".py") else n for n in names]
    except ConfigError as error:
        raise ConfigError(f"{error}; one from elsewhere is given by --effects FILE.py") from None
    return [*own, *map(str, given)]


def chosen(found: Sequence[str]) -> list[type[Effect]]:
    """These effects; raises EffectError in a sentence whatever a file holds."""
    effects: list[type[Effect]] = []
    for name in found:
        if name.endswith(".py"):
            tried(name, kernel=True)
            if Path(name).stem in all_effects():
                raise EffectError(f"effect file '{name}': the library has an effect of that name")
        effects += find_effects([name])
    names = [effect.name() for effect in effects]
    if twice := [name for name in names if names.count(name) > 1]:
        raise EffectError(f"effect '{twice[0]}' is given twice")
    return effects


def tried(path: str, kernel: bool) -> None:
    """Run a file and its kernel apart, within bounds of time and memory.

    kernel  it has to run as a diagnosis runs it, compiled and beyond its bounds; else it has to be
            able to run at all

    Raises MissingLog or DataError where there is no file to read, EffectError where running fails.
    """
    checked(path, "effect file")
    try:
        loading, own, running = apart(
            _trial, path, LONGEST, needs=(__name__,), longest=WAITED * LONGEST
        )
    except TooLong:
        raise EffectError(
            f"effect file '{path}' does not end in {LONGEST:.0f} s of computing or "
            f"{WAITED * LONGEST:.0f} s in all"
        ) from None
    except Crashed:
        raise EffectError(f"effect file '{path}' ends the process that runs it") from None
    except ValueError as error:
        raise EffectError(f"effect file '{path}': {error}") from None
    said = own or (running if kernel else "")
    if loading or said:
        raise EffectError(loading or f"effect file '{path}': {said}")


def _trial(path: str, longest: float) -> tuple[str, str, str]:
    """What fails when the file is loaded, in its kernel itself, and when that runs compiled.

    Empty where nothing does.
    """
    if hasattr(signal, "setitimer"):  # ends this process, even inside compiled code
        signal.setitimer(signal.ITIMER_PROF, longest)
    try:
        (effect,) = load_file(Path(path)).values()
    except (EffectError, KeyboardInterrupt) as error:
        return str(error) or f"effect file '{path}' fails: {type(error).__name__}", "", ""
    try:
        _run(effect)
    except Exception as error:
        return "", _own_error(effect), str(error) or type(error).__name__
    return "", "", ""


def _own_error(effect: type[Effect]) -> str:
    """What the kernel itself says, interpreted; empty where only its compilation fails."""
    numbers = {name: about.nominal for name, about in effect.parameters().items()}
    try:
        replay.run(
            effect, numbers, replay.motion(effect, np.random.default_rng(0), SAMPLES, STEP), STEP
        )
    except Exception as error:
        return f"its kernel fails: {type(error).__name__}: {error}".rstrip(": ")
    return ""


def _run(effect: type[Effect]) -> None:
    """The kernel, compiled as in a diagnosis, over the bounds of its numbers and signals.

    Beyond them it has to come to an end; what it gives there is nobody's business.  Raises
    EffectError where it gives no number at its nominal ones.
    """
    rng = np.random.default_rng(0)
    loop = loop_of(effect)
    whole, step, out = np.array([0, SAMPLES]), np.array([STEP]), np.zeros(SAMPLES)
    anew, begin = np.ones(1, bool), np.array(list(effect.state.values()), float)

    def over(inputs: replay.Inputs, values: np.ndarray) -> None:
        reads = np.array([inputs[name] for name in effect.reads]).reshape(-1, SAMPLES)
        loop(out, whole, step, anew, begin, inputs.get("upstream", out), reads, values)

    nominal = np.array([about.nominal for about in effect.parameters().values()])
    over(replay.motion(effect, np.random.default_rng(0), SAMPLES, STEP), nominal)
    if not np.all(np.isfinite(out)):
        raise EffectError("its kernel gives no finite number at its nominal numbers")
    for numbers in replay.corners(effect, rng):
        values = np.array([numbers[name] for name in effect.parameters()])
        wild = replay.extremes(effect, rng, SAMPLES)
        over(wild, values)
        over(replay.motion(effect, rng, SAMPLES, STEP), values)
        with suppress(ArithmeticError, ValueError):
            over({name: BEYOND * signal for name, signal in wild.items()}, values)
