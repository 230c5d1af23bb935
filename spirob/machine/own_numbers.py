"""All numbers of a rig's inverse model: its own, then those of the effects, brought to its size."""

from collections.abc import Sequence

from spirob.effects import Effect
from spirob.machine.log_numbers import LogNumbers
from spirob.machine.rig import NUMBERS, RigFile
from spirob.machine.scaling import Sizes, parameters
from spirob.parameter import Parameter, Table

SYMBOLS = {
    "inertia": "J",
    "viscous": "b",
    "stiffness": "k",
    "scale": "k_e",
    "delay": "δ",
    "back_emf": "k_b",
    "payload_inertia": "J_p",
    "payload_cosine": "P_c",
    "payload_sine": "P_s",
}
ABSENT = {"scale": 1.0}  # what a number is that the description does not name; the others are 0
FAMILIAR = {"N·s²/m": "kg", "N·m·s²/rad": "kg·m²"}


def table_of(
    rig: RigFile, effects: Sequence[type[Effect]], sizes: Sizes, logs: LogNumbers
) -> Table:
    """Names, bounds and values; the effects' numbers are neutral."""
    about = {f"rig.{name}": _own(rig, name, sizes) for name in NUMBERS}
    values = {f"rig.{name}": value for name, value in rig.known.items()}
    for effect in effects:
        for field, number in parameters(effect, sizes).items():
            full = f"{effect.name()}.{field}"
            about[full] = number
            declared = effect.parameters()[field]
            if field in effect.neutral:
                values[full] = effect.neutral[field] * sizes.ratio(declared.unit)
    return Table.of(about | logs.about, values | logs.known)


def _own(rig: RigFile, name: str, sizes: Sizes) -> Parameter:
    units = {
        "inertia": f"{sizes.torque_unit}·s²/{sizes.axis_unit}",
        "viscous": f"{sizes.torque_unit}·s/{sizes.axis_unit}",
        "stiffness": f"{sizes.torque_unit}/{sizes.axis_unit}",
        "scale": f"{sizes.torque_unit}/{sizes.effort_unit}",
        "delay": "s",
        "back_emf": f"V·s/{sizes.axis_unit}",
        "payload_inertia": f"{sizes.torque_unit}·s²/{sizes.axis_unit}",
        "payload_cosine": sizes.torque_unit,
        "payload_sine": sizes.torque_unit,
    }
    unit = FAMILIAR.get(units[name], units[name])
    chosen = rig.fit.get(name)
    value = rig.known.get(name, ABSENT.get(name, 0.0))
    low, high, nominal = value, value, value
    if chosen is not None:
        low, high, nominal = chosen.low, chosen.high, chosen.nominal
    return Parameter(nominal, low, high, unit, SYMBOLS[name], NUMBERS[name])
