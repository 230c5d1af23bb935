"""What the passive experiments with the current loop on the host share: sets of gains, and rigs.

A set is a bandwidth at which the gains are placed, and the share of the back-EMF that the loop
feeds forward: all of it, as (12) has it, or none.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from spirob.control.host_gains import placed
from spirob.control.host_loop import HostLoop
from spirob.experiments.direct_drive import DIRECT
from spirob.experiments.experiment import row
from spirob.plant.nominal import Motor


@dataclass(frozen=True)
class GainSet:
    """bandwidth [Hz], share of the back-EMF that is fed forward, latency [s] as the host has it."""

    bandwidth: float
    share: float
    latency: float

    @property
    def key(self) -> str:
        """For the name of a play."""
        return f"{self.bandwidth:g}Hz_{100 * self.share:.0f}"

    @property
    def words(self) -> str:
        """For a table."""
        forward = {1.0: "(12) whole", 0.0: "without back-EMF"}
        told = forward.get(self.share, f"{self.share:.0%} of the back-EMF")
        return f"{self.bandwidth:g} Hz {told}"

    def rig(self) -> dict[str, Any]:
        """The rig without gearbox, its loop on the host."""
        host = {"bandwidth": float(self.bandwidth), "latency": float(self.latency)}
        drive = {"loop": "host", "emf_compensation": float(self.share), "host": host}
        return {**DIRECT, "drive": drive}

    def margin(self) -> dict[str, Any]:
        """Row of the factor by which the gains may grow, by the nominal winding."""
        motor = Motor()
        loop = HostLoop(bandwidth=self.bandwidth, latency=self.latency)
        found = placed(loop, motor.resistance, motor.inductance)
        return row(
            f"gain margin, {self.bandwidth:g} Hz", "1", {"base": found.times}, note=found.told()
        )


def gain_sets(
    bandwidths: Sequence[float], shares: Sequence[float], latency: float
) -> list[GainSet]:
    """All of them, share by share."""
    return [GainSet(bandwidth, share, latency) for share, bandwidth in product(shares, bandwidths)]
