"""How physics is compiled: without the interpreter's lock, IEEE order of operations kept.

No fast-math: the same seed gives the same bits.  Only the entry point is cached on disk; see
`layout.fingerprint` for why the others are not.
"""

import numba

HINGES = 48
SIDES = 2
compiled = numba.njit(nogil=True, error_model="numpy")
compiled_entry = numba.njit(nogil=True, error_model="numpy", cache=True)
