"""A copy of the project in an empty folder, with the short presets, as a user would run it."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import yaml

from spirob.cli.project import discard_torn

SOURCE = Path(__file__).parents[2]
SHORT = [
    "recordings=short",
    "identify=short",
    "diagnose=short",
    "perceive=short",
    "passive=short",
    "paper=short",
    "trial=short",
]
KEPT = (
    "data/sweep/README.md",
    "data/recorded/README.md",
    "reports/trial/cases.jsonl",
    "reports/trial/by.txt",
)
MEASURED = "reports/metrics/contacts.json"  # of the release, in its report; no stage makes it
COMPILED = (".pyc", ".nbi", ".nbc")  # by Python, by Numba
TRIES = 3  # of a run that DVC refuses
IN_A_ROW = """import sys
from importlib import import_module
from pathlib import Path
for name in sys.argv[1:]:
    import_module(f"pipeline.{name}").stage(Path("."))
"""
DECIDING = ("identify", "compare", "diagnose", "decide")  # stages that must not know the truth


def _unfinished(folder: str, names: list[str]) -> list[str]:
    """What another process is writing; what is compiled comes along, it takes half a minute."""
    return [name for name in names if "__pycache__" in folder and not name.endswith(COMPILED)]


ONE_CORE = {"LOKY_MAX_CPU_COUNT": "1"}  # a process begun beside costs more than it plays


class Project:
    """Runs stages and DVC in its folder with this interpreter.

    Stages work on one core, as other tests have the others, until `all_cores` says otherwise.
    """

    all_cores = False

    def __init__(self, root: Path, overrides: list[str]):
        self.root = root
        for folder in ("conf", "pipeline", "spirob"):
            shutil.copytree(SOURCE / folder, root / folder, ignore=_unfinished)
        for file in ("dvc.yaml", ".dvcignore", "data/.gitignore", MEASURED, *KEPT):
            (root / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(SOURCE / file, root / file)
        self.override(overrides)
        self.run("git", "init", "-q")
        self.run(sys.executable, "-m", "dvc", "init", "-q")

    def copied(self, root: Path, *left_out: str) -> "Project":
        """The project as it is now, in another folder, without files of some names."""
        shutil.copytree(self.root, root, ignore=shutil.ignore_patterns(*left_out))
        copy = Project.__new__(Project)
        copy.root = root
        return copy

    def override(self, overrides: list[str]) -> None:
        """Write params.yaml."""
        (self.root / "params.yaml").write_text(f"overrides: {overrides!r}\n")

    def run(self, *command: str, code: int = 0) -> str:
        """Run to the end and return what it printed; the exit code must be as expected."""
        done = subprocess.run(
            command, cwd=self.root, env=self._environment(), capture_output=True, text=True
        )
        said = done.stdout + done.stderr
        assert done.returncode == code, f"{command} ended with {done.returncode}:\n{said}"
        return said

    def stage(self, name: str, code: int = 0) -> str:
        """Run one stage without DVC."""
        return self.run(sys.executable, "-m", f"pipeline.{name}", code=code)

    def stages(self, names: Sequence[str]) -> str:
        """Run these, one after another, in one process."""
        return self.run(sys.executable, "-c", IN_A_ROW, *names)

    def repro(self) -> str:
        """`dvc repro` to the end."""
        return self.run(sys.executable, "-m", "dvc", "repro")

    def kill_repro_at(self, stage: str, after: float, later: Sequence[str] = ()) -> bool:
        """Start `dvc repro`, wait until a stage runs, kill everything `after` seconds later.

        False where the stage had nothing to do any more, with everything killed as soon as one of
        the `later` ones runs, so that they still have something to do.  A kill may hit DVC while it
        writes its own files; what `spirob run` does about that is done here, too.  A run that DVC
        refuses is tried again, as a user would, and its words are the failure where it goes on.
        """
        for _ in range(TRIES):
            process, said = self._until([stage, *later])
            if process.poll() is None:
                found = f"pipeline.{stage}" in said
                time.sleep(after if found else 0.0)
                with suppress(ProcessLookupError):  # it may have come to its end
                    os.killpg(process.pid, signal.SIGKILL)
                process.wait()
                discard_torn(self.root)
                return found
            if process.returncode == 0:
                return False
            time.sleep(5.0)
        raise AssertionError(f"before '{stage}' DVC went on refusing:\n{said}")

    def _until(self, stages: Sequence[str]) -> tuple[subprocess.Popen[str], str]:
        """`dvc repro`, still running at one of the stages or at its end, and what it said."""
        process = subprocess.Popen(
            [sys.executable, "-m", "dvc", "repro"],
            cwd=self.root,
            env=self._environment(),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        assert process.stdout is not None
        said = []
        for line in process.stdout:
            said.append(line)
            if any(f"pipeline.{stage}" in line for stage in stages):
                return process, "".join(said)
        process.wait()
        return process, "".join(said)

    def forget(self, stages: Sequence[str]) -> None:
        """As if these stages had never been run: no results, no cache that DVC takes them from."""
        lock = self.root / "dvc.lock"
        held = yaml.safe_load(lock.read_text())
        for stage in stages:
            for out in held["stages"].pop(stage)["outs"]:
                path = self.root / out["path"]
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        lock.write_text(yaml.safe_dump(held))
        shutil.rmtree(self.root / ".dvc/cache/runs")

    def metrics(self) -> dict[str, bytes]:
        """All metrics files, byte for byte."""
        found = sorted((self.root / "reports/metrics").glob("*.json"))
        return {path.name: path.read_bytes() for path in found}

    def _environment(self) -> dict[str, str]:
        own = {"PYTHONPATH": str(self.root), "DVC_NO_ANALYTICS": "1"}
        return {**os.environ, **own, **({} if self.all_cores else ONE_CORE)}
