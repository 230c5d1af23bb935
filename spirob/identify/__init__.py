"""Fit the model's numbers to measurements, with honest intervals.

What is fitted:
    measurement.py      a measured trial in the form in which the model can play it again
    problem.py          what a fit and a search need of any machine: model against measurement
    residual.py         that of the arm: filtered alike on both sides, weighted to one unit; whether
                        the currents belong to the motions at all
The fit, from before it to after it:
    identifiability.py  what moves a signal, what starts on a bound, what cannot be told apart
    scaling.py          the coordinates in which a fit moves
    fit.py, descent.py  bounded robust least squares; its steps, where all else is a simulation
    intervals.py        how sure a fit is, and a score of it
    builds.py           by how much builds of one machine differ after each is fitted
"""
