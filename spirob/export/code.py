"""The equations of an axis as C99 and as a Python module that needs nothing but `math`.

Those of an arm's motors, and the laws of all its effects, as C99.
"""

import keyword
import re
from collections.abc import Sequence

from spirob.export.arm import CorrectedArm, held_by, motor_of
from spirob.export.axis import GIVEN, equations, number_name
from spirob.export.corrected import Corrected
from spirob.export.law import kernel_functions
from spirob.export.translate import HELP, RESERVED
from spirob.robot import MOTORS

HEADER = """\
/* {title}

   {sentence}

   Units: {axis}, s; effort in {effort}; torque or force in {torque}.
   Nothing is allocated and no call takes longer than another: loops have a fixed length.
   Where a motion or dt is not finite, or dt not positive, the answer is 0 and the state stays.
   An effort follows from the motion and what the state remembers, so keep one state for
   {name}_compensate and another for {name}_torque, and reset them when the machine stops.  */
#ifndef {guard}
#define {guard}

#ifdef __cplusplus
extern "C" {{
#endif

typedef struct {{
{fields}
}} {name}_state;

/* Age of a logged effort beside the logged motion [s]. */
extern const double {name}_delay;

/* Forget everything: the axis stands, nothing is carried. */
void {name}_reset({name}_state *state);

/* Effort to command [{effort}] so that the axis makes this motion; once for each step dt [s]. */
double {name}_compensate({name}_state *state, double position, double speed, double acceleration,
    double dt);

/* What drive and effects put on the axis [{torque}] at this effort, friction negative: all but the
   viscous friction, the spring and the inertia.  acceleration: that of the step before. */
double {name}_torque({name}_state *state, double position, double speed, double acceleration,
    double effort, double dt);

/* The effort as the drive reports it; that as late as the bus brings it; once for each cycle. */
double {name}_reported({name}_state *state, double effort, double dt);
double {name}_framed({name}_state *state, double effort, double dt);

/* The position as its sensor reads it, under this load [{torque}]. */
double {name}_seen({name}_state *state, double position, double load);

#ifdef __cplusplus
}}
#endif
#endif
"""
SOURCE = """\
/* {title}: generated from the kernels of its effects; see {name}.h. */
#include "{name}.h"

#include <math.h>

#define STATE {name}_state

{helpers}
{constants}

const double {name}_delay = {delay};

{functions}

void {name}_reset({name}_state *state)
{{
{resets}
}}

double {name}_compensate({name}_state *state, double position, double speed, double acceleration,
    double dt)
{{
    const int usable = dt > 0.0 && isfinite(position + speed + acceleration + dt);
    return usable ? compensate(state, position, speed, acceleration, dt) : 0.0;
}}

double {name}_torque({name}_state *state, double position, double speed, double acceleration,
    double effort, double dt)
{{
    const int usable = dt > 0.0 && isfinite(position + speed + acceleration + effort + dt);
    return usable ? torque(state, position, speed, acceleration, effort, dt) : 0.0;
}}

double {name}_reported({name}_state *state, double effort, double dt)
{{
    return dt > 0.0 && isfinite(effort + dt) ? reported(state, effort, dt) : effort;
}}

double {name}_framed({name}_state *state, double effort, double dt)
{{
    return dt > 0.0 && isfinite(effort + dt) ? framed(state, effort, dt) : effort;
}}

double {name}_seen({name}_state *state, double position, double load)
{{
    return seen(state, position, load);
}}
"""
PYTHON = '''"""{title}

{sentence}

Units: {axis}, s; effort in {effort}; torque or force in {torque}.  Nothing but Python is needed.
An effort follows from the motion and what a state remembers: keep one `State` for `compensate` and
another for `torque`.
"""

import math

{constants}


class State:
    """What the model remembers; `reset` forgets it.

{given}
    """

    def __init__(self):
        self.reset()

    def reset(self):
        """Forget everything: the axis stands, nothing is carried."""
{resets}


{functions}
'''
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


def c_name(name: str) -> str:
    """A machine's name as it may stand in C and in the name of a file."""
    plain = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:40] or "axis"
    taken = plain in RESERVED or keyword.iskeyword(plain) or plain[0].isdigit()
    return f"axis_{plain}" if taken else plain


def c_files(model: Corrected) -> dict[str, str]:
    """Header and source in C99."""
    made, name = equations(model), c_name(model.name)
    told = _about(model) | {"name": name, "guard": f"{name.upper()}_H"}
    fields = [f"    double {f};{_comment(f)}" for f in made.state]
    resets = [f"    state->{f} = {value!r};" for f, value in made.state.items()]
    read = set().union(*(f.read for f in made.functions))
    constants = [
        f"static const double {n} = {v!r};" for n, v in made.constants.items() if n in read
    ]
    functions = "\n\n".join(f.c for f in made.functions)
    return {
        f"{name}.h": HEADER.format(**told, fields="\n".join(fields)),
        f"{name}.c": SOURCE.format(
            **told,
            helpers=HELP,
            constants="\n".join(constants),
            functions=functions,
            delay=repr(model.numbers["delay"]),
            resets="\n".join(resets),
        ),
    }


def c_files_of_arm(model: CorrectedArm) -> dict[str, str]:
    """Header and source for each motor, and all laws in a header of their own."""
    found: dict[str, str] = {}
    for motor in MOTORS:
        found |= c_files(motor_of(model, motor))
    name = c_name(model.name)
    told = about(model.name, model.sentence, [e.name() for e in model.effects])
    laws = []
    for one in held_by(model, "left"):
        numbers = ", ".join(f"{n} = {v!r}" for n, v in one.values.items())
        laws.append(f"/* {one.name} at {one.law.port}: {numbers} */")
        laws += [f.c for f in kernel_functions(one)]
    guard = f"{name.upper()}_LAWS_H"
    found[f"{name}_laws.h"] = LAWS.format(**told, guard=guard, helpers=HELP, laws="\n\n".join(laws))
    return found


def python_text(model: Corrected) -> str:
    """The module in Python."""
    made = equations(model)
    given = [f"    {f:<12} {meaning}" for f, meaning in GIVEN.items()]
    resets = [f"        self.{f} = {value!r}" for f, value in made.state.items()]
    constants = [f"{n} = {v!r}{_meaning(model, n)}" for n, v in made.constants.items()]
    return PYTHON.format(
        **_about(model),
        given="\n".join(given),
        constants="\n".join(constants),
        resets="\n".join(resets),
        functions=made.python,
    )


def about(name: str, sentence: str, effects: Sequence[str]) -> dict[str, str]:
    """What stands at the head of a file."""
    named = " + ".join(effects) or "fitted numbers alone"
    return {"title": _plain(f"{name}: {named}"), "sentence": _plain(sentence)}


def _about(model: Corrected) -> dict[str, str]:
    return about(model.name, model.sentence, [e.name for e in model.effects]) | {
        "axis": model.axis,
        "effort": _plain(model.effort),
        "torque": _plain(model.torque),
    }


def _plain(text: str) -> str:
    """A text of a file as it may stand in a comment or a docstring."""
    kept = "".join(c if c.isprintable() and c not in '\\"*`{}' else " " for c in text)
    return " ".join(kept.split())[:200]


def _comment(field: str) -> str:
    return f" /* {GIVEN[field]} */" if field in GIVEN else ""


def _meaning(model: Corrected, constant: str) -> str:
    for one in model.effects:
        for number in one.law.numbers:
            if number_name(one, number) == constant:
                return f"  # of {one.name}"
    return ""
