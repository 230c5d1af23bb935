"""The spectrum of a residual over an angle: how periodic it is at each order.

    P(N) = 2 |Σ r exp(-i N θ)|² / (n Σ r²),      θ the angle, r the residual about its mean

the share of its square that a wave of order N explains where the angle is travelled evenly.
"""

import numpy as np

PEAKS = 4
MOST_BINS = 2**20  # of the angle; beyond, the highest orders are not looked at


def peaks(
    residual: np.ndarray, angle: np.ndarray, low: float, high: float, count: int = PEAKS
) -> list[float]:
    """The orders in which the residual is most periodic over the angle, strongest first."""
    orders, power = spectrum(residual, angle, low, high)
    if len(orders) < 3:
        return [float(np.sqrt(low * high))]
    found: list[float] = []
    apart = 2 * np.pi / max(np.ptp(angle), 1e-9)
    for k in np.argsort(-power):
        if all(abs(orders[k] - other) > apart for other in found):
            found.append(float(orders[k]))
        if len(found) == count:
            break
    return found


def spectrum(
    residual: np.ndarray, angle: np.ndarray, low: float, high: float
) -> tuple[np.ndarray, np.ndarray]:
    """Share of the squared residual that a wave of each order explains, (M,) and (M,).

    Orders from one period over the travelled angle, a quarter of a period apart.  The residual is
    summed into bins of the angle, an eighth of the shortest period wide, and transformed at once:
    a sample in the middle of its bin then loses at most 3 % of the shortest wave.
    """
    travel = max(float(np.ptp(angle)), 1e-9)
    width = 2 * np.pi / (8.0 * high)
    count = int(travel / width) + 1
    if count > MOST_BINS:
        width, count = travel / (MOST_BINS - 1), MOST_BINS
    cells = np.minimum(((angle - angle.min()) / width).astype(int), count - 1)
    sums = np.bincount(cells, weights=residual - residual.mean(), minlength=count)
    padded = 4 * count
    power = np.abs(np.fft.rfft(sums, padded)) ** 2
    orders = 2 * np.pi * np.arange(len(power)) / (padded * width)
    inside = (orders >= max(low, 2 * np.pi / travel)) & (orders <= high)
    total = float(np.sum((residual - residual.mean()) ** 2)) * len(residual) / 2.0
    return orders[inside], power[inside] / max(total, 1e-300)
