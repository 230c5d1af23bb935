"""The search for what the model misses, by the rules of `spirob.diagnosis`, and its verdict.

preparation.py   what it stands on: logs, and the effects that can act
models.py        sets of effects, each fitted in full
screening.py     which absent effects explain what is left
delays.py        the delay of the effort
differing.py     do logs differ by a number of their own, or by whole turns
judging.py       the verdict, the law it asks for, whether a law beats the names
dry_friction.py  beside which laws dry friction is told
foretold.py      names with which the motion is foretold worse than without
leftovers.py     what could still be explained, and from what
plausibility.py, odd_logs.py
                 do data and description fit, do the logs fit together
plain_columns.py what inertia, friction, a force and a weight explain alone
wrong_numbers.py numbers beyond their bounds, and masses many times off
"""
