"""Any motor rig: from its description and its logs to what its model misses.

`load_rig` reads the description, `read_trial` a log, `diagnose` does the rest.
"""
