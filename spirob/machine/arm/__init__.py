"""Our arm with its two tendons, logged by somebody else: `body: arm` in a description.

description.py  a whole description: two motors, which machine they drive, what is fitted
motors.py       which columns the two motors have
compared.py     filter and rows of what is compared
numbers.py      what is known of the model's numbers, and between which bounds others are fitted
replay.py       a log as a trial that the model can play again
beginning.py    at rest, under which currents, with the rotors where in a turn
following.py    what holds the model to a measured motion
rows.py         which of its cycles are left out
roles.py        which logs, or parts of one, are fitted, chosen by, held out
blocks.py       a part of a log, played from rest and compared from where it begins
settled.py      what the search stands on: the arm's shape, and the rows that count
shape.py        holes and stiffness of an arm of another design, searched for
tolerated.py    what of the arm's build the logs tell beyond its tolerances
evolve.py       the lowest valley of a cost over a few numbers
determined.py   rows that the arm's numbers determine, whichever its hinges
diagnosis.py    the arm's own search and verdict, as the document of a rig
page.py         what the page shows besides: overlay and fitted numbers
"""
