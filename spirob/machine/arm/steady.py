"""A current as it was given, from what a noisy sensor says of it.

The motor that holds gets its measured current in the model, and its sensor's noise with it.  The
rotors swing on their tendons at some hertz and hardly damped, so noise of 5 mA becomes 2 mA in the
current of the other motor.  Most often that current is held; there a straight average has no noise.
"""

import numpy as np
from scipy import ndimage, signal

from spirob.machine.filtering import smooth

HOLD = 0.5  # s, over which a current that is held has to stay where it is
SPAN = 8.0  # deviations of its noise that it may cover there; white noise covers four to five
SURE = 3.0  # deviations of a mean, beyond which it is another
FIRST = 3  # samples that say whether there is a current before any change of it
SLOW = 1.0  # Hz: what drifts more slowly is no noise


def steadied(current: np.ndarray, cutoff: float, period: float) -> np.ndarray:
    """The current, (T,), where it is held without its noise, elsewhere as it is.

    cutoff  [Hz]; its noise is what lies between this and twice of it
    """
    slow = smooth(current, cutoff, period)
    noise = smooth(current, 2.0 * cutoff, period) - slow
    deviation = 1.4826 * np.median(np.abs(noise - np.median(noise)))
    window = round(HOLD / period) // 2 * 2 + 1
    covered = ndimage.maximum_filter1d(slow, window) - ndimage.minimum_filter1d(slow, window)
    calm = ndimage.binary_dilation(covered <= SPAN * deviation, np.ones(window))
    found = current.copy()
    for (rows,) in ndimage.find_objects(ndimage.label(calm)[0]):
        found[rows] = _averaged(current[rows], period)
    return found


def first_level(current: np.ndarray) -> float:
    """Where a current, (n,), begins: 0 where its first samples cannot be told from their noise.

    It may be asked to change at once.  So the mean reaches only as far as it agrees, within what
    the noise allows, with the means of fewer samples.
    """
    noise = 1.4826 * np.median(np.abs(np.diff(current, n=2))) / np.sqrt(6)
    counts = np.arange(1, len(current) + 1)
    means, widths = np.cumsum(current) / counts, SURE * noise / np.sqrt(counts)
    agree = np.maximum.accumulate(means - widths) <= np.minimum.accumulate(means + widths)
    last = len(agree) - 1 if agree.all() else int(np.argmin(agree)) - 1
    sure = all(abs(means[k]) > widths[k] for k in (FIRST - 1, last))
    return float(means[last]) if sure else 0.0


def _averaged(held: np.ndarray, period: float) -> np.ndarray:
    low_pass = signal.butter(2, SLOW, fs=1.0 / period, output="sos")
    return np.asarray(signal.sosfiltfilt(low_pass, held, padtype="even", padlen=len(held) - 1))
