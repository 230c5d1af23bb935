"""Where the page comes from: source, data, versions, seed and the command that repeats it."""

import hashlib
import platform
import shlex
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from spirob import plain_yaml
from spirob.logs.writer import git_commit, installed, versions

PACKAGES = (
    "scipy",
    "numba",
    "llvmlite",
    "pandas",
    "pyarrow",
    "scikit-learn",
    "mcap",
    "cantools",
    "python-can",
    "hydra-core",
    "dvc",
    "plotly",
)
SOURCE_FOLDERS = ("spirob", "pipeline", "conf", "dvc.yaml", "params.yaml", "pyproject.toml")
COMMAND = "spirob run"


@dataclass(frozen=True)
class Provenance:
    """What is needed to make the page again.

    dirty     True when code or configuration differ from the commit; None without a repository
    changed   files of code and configuration that differ from the commit
    hashes    path -> first 16 digits of its SHA-256, or the folder's hash that DVC recorded
    overrides choices on top of the defaults, as written in params.yaml
    """

    commit: str = "unknown"
    dirty: bool | None = None
    changed: tuple[str, ...] = ()
    seed: str = "not set"
    command: str = COMMAND
    overrides: tuple[str, ...] = ()
    versions: dict[str, str] = field(default_factory=dict)
    hashes: dict[str, str] = field(default_factory=dict)


def collect(root: Path, files: Iterable[str], config: str) -> Provenance:
    """Look at the work tree under `root`, the files read, and the configuration's text."""
    commit = git_commit(root)
    changed = _changed(root)
    overrides = _overrides(root)
    here = {"platform": f"{platform.system()} {platform.machine()}"}
    return Provenance(
        commit=commit,
        dirty=None if commit == "unknown" else bool(changed),
        changed=changed,
        command=_command(overrides),
        seed=_seed(plain_yaml.read(config, "configuration")),
        overrides=overrides,
        versions=versions() | here | installed(PACKAGES),
        hashes=_recorded_hashes(root) | {file: _hash(root / file) for file in files},
    )


def _hash(path: Path) -> str:
    """Of a file's bytes, or of those of all files in a folder, in the order of their names."""
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def _recorded_hashes(root: Path) -> dict[str, str]:
    """Hashes of raw data that DVC has already computed; it writes them to dvc.lock."""
    lock = root / "dvc.lock"
    if not lock.exists():
        return {}
    stages = (yaml.safe_load(lock.read_text(encoding="utf-8")) or {}).get("stages", {})
    entries = [entry for stage in stages.values() for entry in stage.get("outs", ())]
    raw = {e["path"]: e["md5"] for e in entries if e["path"].startswith("data/raw") and "md5" in e}
    return dict(sorted(raw.items()))


def _changed(root: Path) -> tuple[str, ...]:
    """Files of code and configuration that are not as in the commit, renamed and new ones too."""
    present = [name for name in SOURCE_FOLDERS if (root / name).exists()]
    if not present:
        return ()
    command = ["git", "-C", str(root), "status", "--porcelain", "--no-renames", "--", *present]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return ()
    return tuple(line[3:] for line in answer.stdout.splitlines())


def _command(overrides: Sequence[str]) -> str:
    """What makes the page again, whatever stands in params.yaml by then."""
    return shlex.join(["spirob", "run", *(overrides or ["--defaults"])])


def _overrides(root: Path) -> tuple[str, ...]:
    path = root / "params.yaml"
    if not path.exists():
        return ()
    content = yaml.safe_load(path.read_text(encoding="utf-8")) or {}
    return tuple(str(item) for item in content.get("overrides") or ())


def _seed(config: Any) -> str:
    """All keys called 'seed', with the path that leads to them."""
    seeds = [f"{path} = {value}" for path, value in _walk(config) if path.split(".")[-1] == "seed"]
    return ", ".join(seeds) or "not set"


def _walk(node: Any, path: str = "") -> Iterable[tuple[str, Any]]:
    if isinstance(node, dict):
        for key, value in node.items():
            yield from _walk(value, f"{path}.{key}" if path else str(key))
    else:
        yield path, node
