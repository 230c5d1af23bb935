"""What the robot touches, told from its motors alone: the size of an object it wraps.

wrap.py                a wrap as read from a trial: free motion, rise of the current, plateau
feature.py             what a feature is, and the table of all of them
temporal.py, spectral.py, electromechanical.py   the features themselves
features.py            trials -> table of features
base_models.py         the two regressors below, and the checks their inputs go through
size.py                stacking: train and predict diameters
model_file.py          a trained model on disk, with the hash that is checked before loading
score.py               how far predictions are from the truth
"""
