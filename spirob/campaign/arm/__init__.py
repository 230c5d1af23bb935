"""The test of the diagnosis itself: robots with a hidden effect, diagnosed blind, and scored.

strength.py   how strong a hidden effect is drawn
bends.py      a robot with something hidden plays its bends
case.py       one robot, recorded and diagnosed blind
running.py    many in parallel, into one table
rates.py      rates of the table, and the answer key behind them
tracking.py   what the feed-forward of the found model is worth
"""
