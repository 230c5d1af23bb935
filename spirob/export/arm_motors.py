"""The motors of the arm in C: each an axis in rotor coordinates, its load the tendon's torque."""

import inspect
from collections.abc import Callable
from dataclasses import replace

from spirob.effects.effect import SUFFIX, differences
from spirob.export.arm import CorrectedArm
from spirob.export.axis import ADDED, BEFORE, CURRENT, FRAME, REPORT, SHARE
from spirob.export.code import about, c_files, c_name
from spirob.export.corrected import Corrected, Fitted, Held
from spirob.export.law import kernel_functions, law_of
from spirob.export.translate import HELP
from spirob.machine.rig import NUMBERS
from spirob.robot import MOTORS

OF_A_MOTOR = {*ADDED, *BEFORE, CURRENT, FRAME, REPORT, SHARE}
CYCLE = 1e-3  # s
LAWS = """\
/* {title}: the laws of its effects, each with its numbers in the comment before it.

   {sentence}

   A law returns its contribution at its port, or what it makes of `upstream`; the next values of
   what it remembers go to next_1, next_2 ...  */
#ifndef {guard}
#define {guard}

#include <math.h>

{helpers}
{laws}

#endif
"""


def c_files_of_arm(model: CorrectedArm) -> dict[str, str]:
    """Header and source for each motor, and all laws in a header of their own."""
    found: dict[str, str] = {}
    for motor in MOTORS:
        found |= c_files(motor_of(model, motor))
    name = c_name(model.name)
    told = about(model.name, model.sentence, [e.name() for e in model.effects])
    laws = []
    for one in _held(model, "left"):
        numbers = ", ".join(f"{n} = {v!r}" for n, v in one.values.items())
        laws.append(f"/* {one.name} at {one.law.port}: {numbers} */")
        laws += [f.c for f in kernel_functions(one)]
    guard = f"{name.upper()}_LAWS_H"
    found[f"{name}_laws.h"] = LAWS.format(**told, guard=guard, helpers=HELP, laws="\n\n".join(laws))
    return found


def lever_of(model: CorrectedArm, motor: str) -> float:
    """Tendon that a motor winds in for one radian of its rotor [m]."""
    number = number_of(model, motor)
    return number("winch.radius", True) / number("winch.gear_ratio")


def reported_lever(model: CorrectedArm) -> float:
    """The same as the drives report it, which know nothing of their drums' differences [m]."""
    return model.rig.winch.radius / number_of(model, MOTORS[0])("winch.gear_ratio")


def number_of(model: CorrectedArm, motor: str) -> Callable[..., float]:
    """The numbers of the arm by name, on request as they differ at one motor."""
    plant = model.plant()
    p = plant.table.vector(model.changes)
    side = 1.0 if motor == MOTORS[0] else -1.0

    def number(name: str, differs: bool = False) -> float:
        own = float(p[plant.table.position(name)])
        if not differs:
            return own
        return own * (1.0 + side * float(p[plant.table.position(f"{name}_difference")]))

    return number


def motor_of(model: CorrectedArm, motor: str) -> Corrected:
    """One motor as an axis: rotor angle, current, and as `carried` the tendon's torque r·F/G."""
    number, lever = number_of(model, motor), lever_of(model, motor)
    gear = number("winch.gear_ratio")
    efficiency = number("winch.efficiency", True)
    numbers = dict.fromkeys(NUMBERS, 0.0) | {
        "viscous": number("motor.rotor_damping", True),
        "scale": efficiency * number("motor.torque_constant"),
    }
    effects = [e for e in _held(model, motor) if e.law.port in OF_A_MOTOR]
    pulled = [
        replace(e, values={"force": e.values["force"] * lever})
        if e.law.port == "tendon.force" and set(e.values) == {"force"}
        else e
        for e in effects
    ]
    return Corrected(
        f"{model.name} {motor}",
        model.verdict,
        model.sentence,
        "rad",
        "A",
        "N·m",
        numbers,
        1.0,
        number("motor.rest_speed"),
        0.0,
        CYCLE,
        tuple(e for e in pulled if e.law.port != "tendon.force" or set(e.values) == {"force"}),
        Fitted((), (), (), (), (), None),
        own_inertia=number("motor.rotor_inertia", True) + number("winch.drum_inertia") / gear**2,
    )


def _held(model: CorrectedArm, motor: str) -> list[Held]:
    """The effects with the numbers that they have at one motor."""
    plant = model.plant()
    p = plant.table.vector(model.changes)
    side = 1.0 if motor == MOTORS[0] else -1.0
    found = []
    for effect in model.effects:
        text = inspect.getsource(inspect.getmodule(effect))  # type: ignore[arg-type]
        law = law_of(effect.name(), text, effect)
        values = {}
        for field in law.numbers:
            values[field] = float(p[plant.table.position(f"{effect.name()}.{field}")])
            if field + SUFFIX in differences(effect):
                own = p[plant.table.position(f"{effect.name()}.{field}{SUFFIX}")]
                values[field] += side * float(own)
        found.append(Held(law, values))
    return found
