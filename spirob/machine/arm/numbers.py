"""What a description says of the numbers of the arm's model: known, or fitted between bounds."""

from collections.abc import Sequence
from dataclasses import replace

from spirob.effects import Effect
from spirob.errors import ConfigError
from spirob.machine.arm.description import PARTS, ArmFile
from spirob.machine.rig import Bounded
from spirob.parameter import Parameter
from spirob.plant import Plant


def described(plant: Plant, rig: ArmFile, own: Sequence[type[Effect]]) -> Plant:
    """The plant with the description's bounds, starts and known values in its table.

    own  effects that the model holds already

    Raises ConfigError, naming the place, for a number that the model does not have, for bounds
    beyond those within which it is one, and for a known value out of them.
    """
    owners = PARTS | {effect.name() for effect in own}
    about = {n: _between(_about(plant, owners, "fit", n), n, b) for n, b in rig.fit.items() if b}
    for name, value in rig.known.items():
        about[name] = _at(_about(plant, owners, "known", name), name, value)
    for name in rig.fit:
        _about(plant, owners, "fit", name)
    return plant.within(about)


def _about(plant: Plant, owners: set[str], key: str, name: str) -> Parameter:
    """What the model knows of the number `name` of the description's `key`."""
    about, owner = plant.table.about, name.partition(".")[0]
    if owner not in owners and any(known.startswith(f"{owner}.") for known in about):
        raise ConfigError(f"{key}: '{name}' is of an effect that is not among 'effects'")
    if name not in about:
        own = [n.partition(".")[2] for n in about if n.startswith(f"{owner}.")]
        has = f"{owner} has: {', '.join(own)}" if own else f"its parts: {', '.join(sorted(owners))}"
        raise ConfigError(f"{key}: the arm's model has no number '{name}'; {has}")
    return about[name]


def _between(about: Parameter, name: str, chosen: Bounded) -> Parameter:
    if chosen.low < about.low or chosen.high > about.high:
        raise ConfigError(
            f"fit.{name}: {chosen.low:g} to {chosen.high:g} reaches beyond what the model allows, "
            f"{about.low:g} to {about.high:g} {about.unit} ({about.meaning})"
        )
    # a data sheet's tolerance gives way to bounds that were chosen
    return replace(about, nominal=chosen.nominal, low=chosen.low, high=chosen.high, tolerance=0.0)


def _at(about: Parameter, name: str, value: float) -> Parameter:
    if not about.low <= value <= about.high:
        raise ConfigError(
            f"known.{name}: {value:g} is beyond what the model allows, "
            f"{about.low:g} to {about.high:g} {about.unit} ({about.meaning})"
        )
    return replace(about, nominal=value)
