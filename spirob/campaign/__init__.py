"""The test of the diagnosis of rigs: simulated axes that share no code with the diagnosis.

case.py, recorder.py      a machine of `simulators/` with something hidden, and what its logs hold
                          and show of that
running.py                cases diagnosed blind;  results.py  in parallel, into one file
scoring.py                the answer key, what became of each case, rates
true_law.py               what knowing the hidden law would leave
tracking.py               what the feed-forward of the found model is worth
calibration.py            how sure a name may be, from cases whose truth is known
other_laws.py             composed laws beside those of other programs
arm/                      the same of arms
"""
