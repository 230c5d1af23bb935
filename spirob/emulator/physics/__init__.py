"""The compiled step of the emulated machine, one file for each part of it.

Every file declares the numbers it reads (`NUMBERS`), the state it keeps (`STATE`) and the room it
works in (`SCRATCH`), as name -> shape; `layout.py` makes one record of each kind of them.  In
compiled code `p` is the record of numbers, `s` the state, `w` the working room.

Coordinates: φ_i, the absolute angle of unit i; hinge angle q_i = φ_i - φ_{i-1}; side 0 is the
left tendon and drive, side 1 the right.
"""
