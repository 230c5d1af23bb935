"""Any motor rig: from its description and its logs to what its model misses.

`spirob.diagnose` goes from a description and logs to the result.

What a rig is:
    rig.py, columns.py             its description, and the columns of its logs
    controller.py                  what the controller asks for under which a log was made
    loading.py                     both from disk
    body.py, model_file.py         the body behind the motor, of a model in MuJoCo's format
    arm/                           our arm, logged by somebody else
Its logs, made even, filtered, alike:
    selection.py, checks.py, broken_stretches.py
                                   which logs take part, and which of their rows
    recording.py                   one trial in SI
    rests.py                       its rows at which the axis stands
    grids.py, clock.py             even grids of a log's columns; when each row was, and which hold
                                   the frame before
    filtering.py                   its filters
    positions.py, unwrapping.py    a position as the axis moved: jumps told, wraps undone
    measured_speed.py              what a measured speed has to do with its derivative
    motion.py                      the motion of all trials in a row, and what remembers along it
The inverse model, which tells the effort that a motion asks for:
    inverse.py, inverse_equations.py
                                   the model on the trials, and its equations
    numbers.py                     what of it is fitted
    wrong_numbers.py               numbers beyond their bounds, and masses many times off
    delays.py                      the delay of the effort
    scaling.py, shapes.py          the library's numbers at this size; where they start, and which
                                   waves are one
    kernel_loop.py                 effects along whole recordings; back through those that lie
                                   between effort and torque
    swings.py                      what effects begin with
The search, by the rules of `spirob.diagnosis`:
    diagnosis.py, preparation.py   from logs to a verdict, and what the search stands on: logs, and
                                   the effects that can act
    axis.py                        leads fit, delay and search
    judging.py                     the verdict, the law it asks for, whether a law beats the names
    dry_friction.py                beside which laws dry friction is told
    foretold.py                    names with which the motion is foretold worse than without
    models.py                      sets of effects, each fitted in full
    laws/                          laws that a plain axis has instead of the library's
    screening.py                   which absent effects explain what is left
What is left, doubted and shown:
    leftovers.py                   what could still be explained, and from what
    composed/                      by which law
    plausibility.py, odd_logs.py   do data and description fit, do the logs fit together
    plain_columns.py               what inertia, friction, a force and a weight explain alone
    differing.py                   do logs differ by a number of their own, or by whole turns
    forward/                       the model run forward
    result.py, document.py, page_tables.py
                                   what was found, as plain data and for the page
"""
