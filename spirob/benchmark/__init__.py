"""How fast the model and what is built on it run, as ratios measured in one run.

Each file measures one thing: `measure(size)` returns figures by key.  What is compared is run in
turns, so that whatever else the machine does falls on both sides alike, and medians are reported.
"""
