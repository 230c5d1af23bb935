"""Where a log comes from: versions of what made it, and the state of the source."""

import platform
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import spirob

PACKAGES = ("numpy", "mujoco")


def versions() -> dict[str, str]:
    """Versions of Python, spirob and of the packages that decide the numbers."""
    found = {"python": platform.python_version(), "spirob": spirob.__version__}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "absent"
    return found


def git_commit(folder: Path | str) -> str:
    """Commit of the work tree that `folder` lies in; 'unknown' where there is none."""
    command = ["git", "-C", str(folder), "rev-parse", "HEAD"]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return answer.stdout.strip()
