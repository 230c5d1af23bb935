"""What the pipeline consists of, as dvc.yaml says, and how long each stage took last time.

The times are kept in .dvc/tmp, which is not under version control; they only serve the forecast.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from spirob.errors import ConfigError
from spirob.logs.atomic import write_text

TIMES = Path(".dvc/tmp/stage_seconds.json")


def stages(project: Path, target: str | None = None) -> list[str]:
    """Stages that a run up to `target` (or to the end) passes through, in the order of dvc.yaml.

    Raises ConfigError for a target that is no stage.
    """
    import yaml

    try:
        found = yaml.safe_load((project / "dvc.yaml").read_text(encoding="utf-8"))["stages"]
    except (yaml.YAMLError, KeyError, TypeError) as error:
        raise ConfigError(f"dvc.yaml lists no stages: {error}") from None
    if target is None:
        return list(found)
    if target not in found:
        raise ConfigError(f"no stage '{target}'; stages: {', '.join(found)}")
    needed = [target]
    for name in needed:  # grows while it is walked
        for other in found:
            if other not in needed and _feeds(found[other], found[name]):
                needed.append(other)
    return [name for name in found if name in needed]


def _feeds(stage: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    written = _paths(stage.get("outs")) + _paths(stage.get("metrics"))
    read = _paths(other.get("deps")) + _paths(other.get("params"))
    return any(_overlap(out, use) for out in written for use in read)


def _paths(entries: list[Any] | None) -> list[str]:
    return [next(iter(entry)) if isinstance(entry, dict) else entry for entry in entries or []]


def _overlap(first: str, second: str) -> bool:
    return first == second or first.startswith(f"{second}/") or second.startswith(f"{first}/")


def times(project: Path) -> dict[str, float]:
    """Seconds that each stage took last time, as far as they are known."""
    try:
        found = json.loads((project / TIMES).read_text(encoding="utf-8"))
        return {str(stage): float(seconds) for stage, seconds in found.items()}
    except (OSError, ValueError, AttributeError, TypeError):
        return {}  # a missing or damaged record only costs the forecast


def keep_times(project: Path, taken: Mapping[str, float]) -> None:
    """Remember the times of this run."""
    if taken and (project / ".dvc").is_dir():
        kept = {stage: round(seconds, 1) for stage, seconds in taken.items()}
        write_text(project / TIMES, json.dumps(times(project) | kept) + "\n")
