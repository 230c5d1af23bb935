"""Any motor rig: from its description and its logs to what its model misses.

`spirob.diagnose` goes from a description and logs to the result.
"""
