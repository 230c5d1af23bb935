"""Logs as trials: made even, filtered alike, in SI.

recording.py    one trial
selection.py    which logs take part, and which are held out
checks.py, broken_stretches.py
                which of their rows
saturation.py, rests.py
                rows at which the drive saturates, at which the axis stands
grids.py, clock.py
                even grids of a log's columns; when each row was, and which hold the frame before
filtering.py    filters
positions.py, unwrapping.py
                a position as the axis moved: jumps told, wraps undone
measured_speed.py
                what a measured speed has to do with the derivative of the position
"""
