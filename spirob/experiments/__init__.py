"""The paper's experiments: what is played, and what is measured on each side that played it.

experiment.py     one side of one trial: robot, model or baseline, as signals; what an experiment
                  is; plans in plain data; the table of all of them
response.py       when a signal answers, and by how much; the detector's answer to a contact, while
                  a trial is played
delay.py, hysteresis.py, extreme_curl.py, single_contact.py, periodic_contact.py, active_contact.py
                one experiment each: its settings, its trials, its measure
direct_drive.py   what the two passive ones share
contact_rates.py  how often and how soon contacts are told, over many uncurlings

Measures are pure functions of signals; they do not know who played.  The paper's figure stands
beside ours in every result, and nothing is adjusted to meet it: the paper gives neither the size
nor the stiffness of its arm.
"""

from spirob.experiments.experiment import (
    EXPERIMENTS,
    Experiment,
    Play,
    Side,
    Sides,
    experiment_from,
)

__all__ = ["EXPERIMENTS", "Experiment", "Play", "Side", "Sides", "experiment_from"]
