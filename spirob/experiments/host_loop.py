"""What the passive experiments with the current loop on the host share: gains, rig and trials.

A set of gains is a bandwidth at which they are placed, and the share of the back-EMF that the loop
feeds forward: all of it, as (12) has it, or none.  Such a loop lets the rotor's speed into the
current, and a pushed rotor turns the drum along: the rig has the drum's inertia, by its drawing.
"""

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar

from spirob.control.host_loop import HostLoop, placed
from spirob.errors import ConfigError
from spirob.experiments.direct_drive import DIRECT, DRUM
from spirob.experiments.experiment import Experiment, Play, row
from spirob.plant.rig import Motor


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
        winch = {**DIRECT["winch"], "drum_inertia": float(DRUM)}
        return {**DIRECT, "winch": winch, "drive": drive}

    def margin(self) -> dict[str, Any]:
        """Row of the factor by which the gains may grow, by the nominal winding."""
        motor = Motor()
        loop = HostLoop(bandwidth=self.bandwidth, latency=self.latency)
        found = placed(loop, motor.resistance, motor.inductance)
        return row(
            f"gain margin, {self.bandwidth:g} Hz", "1", {"base": found.times}, note=found.told()
        )


@dataclass(frozen=True, kw_only=True)
class OnHost(Experiment):
    """Trials of another experiment under each set of gains: with a contact at each place, and none.

    bandwidths  at which the gains of the loop are placed [Hz]
    shares      of the back-EMF that it feeds forward;  latency  from a reading to its voltage [s]
    shots       of a robot, whose mean is looked at
    """

    named: ClassVar[str]  # what its plays are called
    bandwidths: tuple[float, ...] = (5.0, 10.0, 20.0)
    shares: tuple[float, ...] = (1.0, 0.0)
    latency: float = 0.001
    shots: int = 1

    if TYPE_CHECKING:  # of the experiment whose trials are played
        places: tuple[float, ...] = ()

        def trial_at(self, name: str, place: float | None) -> dict[str, Any]: ...

    def __post_init__(self) -> None:
        if self.shots < 1:
            name = type(self).__module__.rpartition(".")[2]
            raise ConfigError(f"paper.{name}.shots = {self.shots}: one at least")

    @property
    def sets(self) -> list[GainSet]:
        """Every set of gains, share by share."""
        found = product(self.shares, self.bandwidths)
        return [GainSet(bandwidth, share, self.latency) for share, bandwidth in found]

    @property
    def slowest(self) -> GainSet:
        """The set under which a contact shows best."""
        return GainSet(self.bandwidths[0], self.shares[-1], self.latency)

    def plays(self) -> list[Play]:
        """Every trial under every set."""
        named = [(self.play_of(one, p), p, one) for one in self.sets for p in (None, *self.places)]
        return [
            Play(name, self.trial_at(name, place), one.rig(), shots=self.shots, noisy=True)
            for name, place, one in named
        ]

    def play_of(self, one: GainSet, place: float | None) -> str:
        """Its name."""
        return f"{self.named}_{one.key}_{'free' if place is None else f'{100 * place:.0f}'}"
