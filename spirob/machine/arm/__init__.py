"""Our arm with its two tendons, logged by somebody else: `body: arm` in a description.

description.py  a whole description: two motors, which machine they drive, what is fitted; which
                columns the two motors have; filter and rows of what is compared; what holds the
                model to a measured motion; what is known of its numbers, and which are fitted
replay.py       a log as a trial that the model can play again; at rest, with the rotors where in a
                turn; held-out trials as plain data beside a diagnosis, and as trials again
rest.py         under which currents a log begins: read from its first samples, fitted to the whole
rows.py         which logs, or blocks of one, are fitted, chosen by, held out; which cycles of them
                are left out; those that the arm's numbers determine, whichever its hinges
preparation.py  what the search stands on: where logs begin, the arm's shape, the rows that count
shape.py        holes and stiffness of an arm of another design, searched for; the lowest valley of
                a cost over a few numbers; what of its build the logs tell beyond tolerances
diagnosis.py    the arm's own search and verdict, as the document of a rig; what the page shows
                besides: overlay and fitted numbers
"""
