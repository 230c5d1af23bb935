"""The folder that the pipeline's commands work in, and the choices made in its params.yaml."""

import re
from collections.abc import Sequence
from pathlib import Path

from spirob.errors import ConfigError
from spirob.logs.atomic import write_text

MARKS = ("dvc.yaml", "params.yaml", "pipeline")
CHOICES = re.compile(r"^overrides:.*(?:\n[ \t-].*)*\n?", re.MULTILINE)
OVERRIDE = re.compile(r"^(?:~[\w./@-]+|\+{0,2}[\w./@-]+=.*)$", re.DOTALL)


def find_project(given: str | None) -> Path:
    """The folder named, or the nearest one above the current that holds the pipeline.

    Raises ConfigError where there is none.
    """
    tried = [Path(given)] if given else [Path.cwd(), *Path.cwd().parents]
    for folder in tried:
        if all((folder / mark).exists() for mark in MARKS):
            return folder.resolve()
    where = f"'{given}'" if given else f"'{Path.cwd()}' and the folders above it"
    raise ConfigError(f"no pipeline in {where}: dvc.yaml, params.yaml and pipeline/ belong to it")


def spelt_out(project: Path, choices: Sequence[str]) -> list[str]:
    """The choices, with the name of presets as a choice of each: `short`, `identify=short` ..."""
    out: list[str] = []
    for choice in choices:
        found = sorted((project / "conf").glob(f"*/{choice}.yaml")) if choice.isidentifier() else []
        out += [f"{preset.parent.name}={choice}" for preset in found] or [choice]
    return out


def read_overrides(project: Path) -> list[str]:
    """The choices on top of the defaults, as params.yaml lists them."""
    import yaml

    try:
        content = yaml.safe_load((project / "params.yaml").read_text(encoding="utf-8")) or {}
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ConfigError(f"params.yaml is not YAML: {error}") from None
    found = content.get("overrides") if isinstance(content, dict) else None
    if found is not None and not isinstance(found, list):
        raise ConfigError("params.yaml: 'overrides' must be a list, e.g. ['rig=spirob']")
    return [str(item) for item in found or []]


def write_overrides(project: Path, overrides: Sequence[str]) -> None:
    """Put the choices into params.yaml and leave everything else in it as it is."""
    import yaml

    for item in overrides:
        if not OVERRIDE.match(item):
            raise ConfigError(
                f"'{item}' is no KEY=VALUE, such as robot.hidden.effect=cogging, and no preset, "
                "such as short"
            )
    path = project / "params.yaml"
    text = path.read_text(encoding="utf-8")
    listed = yaml.safe_dump(list(overrides), default_flow_style=True, width=10_000).strip()
    line = f"overrides: {listed}\n"
    if CHOICES.search(text):
        changed = CHOICES.sub(lambda _: line, text, count=1)
    else:
        changed = text + ("" if text.endswith("\n") or not text else "\n") + line
    if changed != text:
        write_text(path, changed)
