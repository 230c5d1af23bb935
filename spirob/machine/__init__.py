"""Any motor rig: from its description and its logs to what its model misses.

`spirob.diagnose` goes from a description and logs to the result.  The rooms, from below:

    description/    what a rig is, as its owner describes it
    recordings/     its logs, made even, filtered, alike
    laws/           laws that a plain axis has instead of the library's
    inverse/        the model, which tells the effort that a motion asks for
    forward/        the model run forward
    composed/       a law for what the library lacks
    search/         what the model misses, and the verdict
    arm/            our arm, logged by somebody else

loading.py          a description and its logs from disk
diagnosis.py        from logs to a verdict
axis.py             leads fit, delay and search
result.py, document.py, page_tables.py
                    what was found, as plain data and for the page
"""
