"""How late the loop's cycles ended, by their deadlines: what goes into the log of a trial."""

from array import array

import numpy as np

EDGES = (0, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)  # µs, the last bin is open


class Lateness:
    """One number for each cycle [ns]; 8 bytes each."""

    def __init__(self) -> None:
        self._late = array("q")

    def ended(self, late_ns: int) -> None:
        """A cycle has come to its end that long after its deadline."""
        self._late.append(late_ns)

    def restart(self) -> None:
        """Forget everything, for another trial."""
        del self._late[:]

    def summary(self) -> dict[str, str]:
        """Number of cycles, median, 99 % and most [µs], and how many in each bin from `EDGES`."""
        late = np.maximum(np.frombuffer(self._late, np.int64), 0) / 1e3
        if not len(late):
            return {}
        counts, _ = np.histogram(late, [*EDGES, np.inf])
        middle, most_of = np.percentile(late, (50, 99))
        return {
            "cycles": str(len(late)),
            "lateness_p50_us": f"{middle:.1f}",
            "lateness_p99_us": f"{most_of:.1f}",
            "lateness_max_us": f"{late.max():.1f}",
            "histogram_from_us": " ".join(map(str, EDGES)),
            "histogram": " ".join(map(str, counts)),
        }
