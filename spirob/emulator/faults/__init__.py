"""What goes wrong between the drives and the controller; one file each.

A file here defines one class of `Fault`; the file's name is its kind.  A configuration lists them:

    faults:
      - {kind: lost, motor: left, start: 0.5, duration: 2.0, probability: 0.1}
      - {kind: late, frames: command, delay: 0.004}

motor   left, right or both (default);  frames  feedback (default), command or both, for faults of
the bus;  start, duration [s] and all else are numbers of the kind.
"""

from collections.abc import Mapping, Sequence
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

from spirob.emulator.faults.fault import Fault, Placed, Wire
from spirob.errors import ConfigError
from spirob.robot import MOTORS

DIRECTIONS = {"feedback": ("feedback",), "command": ("command",), "both": ("feedback", "command")}

__all__ = ["Fault", "Wire", "kinds", "wire_from"]


def kinds() -> list[str]:
    """Names of all faults."""
    return sorted(found.name for found in iter_modules(__path__) if found.name != "fault")


def load(kind: object) -> type[Fault]:
    """The class of one kind; raises ConfigError with the known ones."""
    if kind not in kinds():
        raise ConfigError(f"no fault '{kind}'; known: {', '.join(kinds())}")
    module = import_module(f"{__name__}.{kind}")
    found = [
        value
        for value in vars(module).values()
        if isinstance(value, type) and issubclass(value, Fault) and value is not Fault
    ]
    assert len(found) == 1, f"{kind} defines {len(found)} faults"
    return found[0]


def wire_from(plain: Sequence[Mapping[str, Any]]) -> Wire:
    """The wire with the faults that a configuration lists.

    Raises ConfigError naming the fault's place in the list and the key.
    """
    return Wire([_placed(given, f"robot.faults[{k}]") for k, given in enumerate(plain)])


def _placed(given: Mapping[str, Any], where: str) -> Placed:
    numbers = {k: v for k, v in given.items() if k not in ("kind", "motor", "frames")}
    kind = load(given.get("kind"))
    motor = given.get("motor", "both")
    frames = given.get("frames", kind.frames)
    if motor not in (*MOTORS, "both"):
        raise ConfigError(f"{where}: motor must be {', '.join(MOTORS)} or both, not {motor!r}")
    if frames not in DIRECTIONS:
        raise ConfigError(f"{where}: frames must be {', '.join(DIRECTIONS)}, not {frames!r}")
    for key, value in numbers.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ConfigError(f"{where}: {key} must be a number, not {value!r}")
    try:
        fault = kind.from_mapping(numbers)
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}") from None
    assert isinstance(fault, Fault)
    motors = frozenset(m for m, name in enumerate(MOTORS) if motor in (name, "both"))
    return Placed(fault, motors, DIRECTIONS[frames])
