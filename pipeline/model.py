"""The model and the measured trials of a configuration, ready to compare."""

from collections.abc import Sequence
from pathlib import Path

from pipeline.schema import Config
from pipeline.stage import read_json, trace_of, workers
from spirob.diagnosis.criteria import weighed_at
from spirob.diagnosis.simulated import ROLES
from spirob.effects import Effect, find_effects
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Filter, Residual, refuse_senseless
from spirob.plant import Plant, Rig


def plant(config: Config, more: Sequence[type[Effect]] = ()) -> Plant:
    """The configured model, with more effects at their neutral numbers."""
    own = find_effects(config.plant.effects)
    return Plant(Rig.from_mapping(config.rig), [*own, *(e for e in more if e not in own)])


def start(config: Config) -> dict[str, float]:
    """Nominal numbers of the effects that the configured model holds."""
    own = find_effects(config.plant.effects)
    return {f"{e.name()}.{f}": p.nominal for e in own for f, p in e.parameters().items()}


def fitted_names(config: Config) -> list[str]:
    """Parameters to fit: the configured ones and those of the model's own effects."""
    own = find_effects(config.plant.effects)
    return [*config.identify.parameters, *(f"{e.name()}.{f}" for e in own for f in e.fitted())]


def measurements(root: Path, config: Config, role: str) -> list[Measurement]:
    """The decoded trials of the experiment with this role."""
    chosen = [t["name"] for t in config.recordings.trials if t["role"] == role]
    return [Measurement.from_trace(trace_of(root, name)) for name in chosen]


def residual(root: Path, config: Config, model: Plant, role: str) -> Residual:
    """Model minus measurement on the trials of one role."""
    settings = config.identify
    return Residual(
        model,
        measurements(root, config, role),
        Filter(**settings.filter.model_dump()),
        settings.current,
        settings.length,
        workers(),
    )


def weighed_residuals(root: Path, config: Config, model: Plant) -> dict[str, Residual]:
    """All trials by role, weighted by what builds of the identified machine differ by in them.

    Raises DataError where the currents of a role do not follow from its motion.
    """
    base = read_json(root / "data/identified/base.json", "identify")
    own = {role: residual(root, config, model, role) for role in ROLES}
    for role in ("validate", "heldout"):  # the stage `identify` asked it of those that are fitted
        refuse_senseless(own[role], own[role](base["changes"]))
    return weighed_at(base["changes"], list(base["parameters"]), own, config.identify.scale)
