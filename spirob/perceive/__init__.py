"""What the robot touches, told from its motors alone: the size of an object it wraps.

wrap.py         a wrap from a trial, or the reason why it is none; a wrap in its parts: free
                motion, rise of the current, plateau; what a feature of it is
features.py     the features themselves; trials -> table of features
size.py         stacking: train and predict diameters; the two regressors below, and the
                preparation of their inputs; folds that hold whole diameters out
model_file.py   a trained model on disk, with the hash that is checked before loading
contact.py      contact, sample by sample, from one current; the same for whole logs, to try many
                thresholds
interval.py     errors on held-out sizes; an interval with every size, or a refusal
study.py        how far predictions are from the truth; what the shipped predictor is compared with;
                which features it needs, and how many samples
passive.py      a push felt in the current of motors that hold it, and where along the arm
live.py         contact, size and pushes from a bus, while it happens; samples on a grid, a wrap
                that grows
"""
