"""The compiled step of the emulated machine.

step.py                the step, one bus cycle made of such steps, and its records
arm.py, contact.py     the arm as a planar chain; what it touches, itself included
tendon.py, motor.py    tendons and guides; from a current to the tendon
drive.py               from a voltage to a current, and what is reported

Every file declares the numbers it reads (`NUMBERS`), the state it keeps (`STATE`) and the room it
works in (`SCRATCH`), as name -> shape; `step.py` makes one record of each kind of them.  In
compiled code `p` is the record of numbers, `s` the state, `w` the working room.

Coordinates: φ_i, the absolute angle of unit i; hinge angle q_i = φ_i - φ_{i-1}; side 0 is the
left tendon and drive, side 1 the right.

Compiled code runs without the interpreter's lock and keeps IEEE order of operations (no fast-math):
the same seed gives the same bits.  Only the entry point is cached on disk; see `step.fingerprint`
for why the others are not.
"""

import numba

HINGES = 48
SIDES = 2
compiled = numba.njit(nogil=True, error_model="numpy")
compiled_entry = numba.njit(nogil=True, error_model="numpy", cache=True)
