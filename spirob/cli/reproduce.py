"""Runs the pipeline as a process of its own (`dvc repro`) and follows it, stage by stage."""

import collections
import os
import re
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from spirob.cli.exit_codes import BUG, DONE, MISTAKE, STOPPED
from spirob.cli.interrupted import discard_torn
from spirob.cli.progress import Progress
from spirob.cli.stages import keep_times, stages, times
from spirob.ending import ended_together

RUNNING = re.compile(r"^Running stage '(?P<stage>[\w@-]+)'")
IDLE = re.compile(r"^Stage '(?P<stage>[\w@-]+)' (?P<why>didn't change|is cached)")
FAILED = re.compile(
    r"^ERROR: failed to reproduce '(?P<stage>[\w@-]+)'.*exited with (?P<code>-?\d+)"
)
LAST_LINES = 40  # of a failing stage
CHATTER = ("Updating lock", "Generating lock", "To track the changes", "\tgit add", "> ")


def _last_lines() -> collections.deque[str]:
    return collections.deque(maxlen=LAST_LINES)


@dataclass
class Outcome:
    """How a run ended.

    code    exit code of the run;  failed  stage that failed, and  stage_code  its own exit code
    lines   the last that were said by the stage that ran last
    """

    code: int = DONE
    failed: str = ""
    stage_code: int | None = None
    lines: collections.deque[str] = field(default_factory=_last_lines)


def reproduce(project: Path, target: str | None = None, verbose: bool = False) -> Outcome:
    """Bring the results up to date, up to the stage `target`.

    verbose  shows what the stages say, too; a stage that fails is always heard
    """
    for name in discard_torn(project):
        print(f"{name} was torn by a kill and is written anew", file=sys.stderr)
    command = [sys.executable, "-m", "dvc", "repro", *([target] if target else [])]
    with Progress(stages(project, target), times(project)) as progress:
        process = subprocess.Popen(
            command,
            cwd=project,
            env={**os.environ, "PYTHONUNBUFFERED": "1", "DVC_NO_ANALYTICS": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            encoding="utf-8",
            errors="replace",
        )
        assert process.stdout is not None
        try:
            with ended_together(process):  # it leaves nothing half-written
                outcome = follow(process.stdout, progress, verbose)
                process.wait()
        finally:
            keep_times(project, progress.taken)
    outcome.code = DONE if process.returncode == 0 else exit_code(outcome)
    if outcome.code != DONE and not verbose:
        print("\n".join(outcome.lines), file=sys.stderr)
    return outcome


def follow(lines: Iterable[str], progress: Progress, verbose: bool = False) -> Outcome:
    """Read what DVC and the stages say, to the end."""
    outcome, current = Outcome(), ""
    for raw in lines:
        line = raw.rstrip()
        running, idle, failed = (pattern.match(line) for pattern in (RUNNING, IDLE, FAILED))
        if failed:
            outcome.failed, outcome.stage_code, current = failed["stage"], int(failed["code"]), ""
        elif running or idle:
            if current:
                progress.done(current)
            current = running["stage"] if running else ""
            outcome.lines.clear()
            if running:
                progress.begin(current)
            elif idle:
                progress.done(idle["stage"], _why(idle["why"]))
        elif line and not line.startswith(CHATTER):
            outcome.lines.append(line)
            if verbose:
                progress.tell(f"  {line}")
    if current:
        progress.done(current)
    return outcome


def exit_code(outcome: Outcome) -> int:
    """Exit code of a run that failed: that of its stage where it means something to us."""
    if outcome.stage_code in (MISTAKE, STOPPED):
        return int(outcome.stage_code)
    traceback = any(line.startswith("Traceback") for line in outcome.lines)
    return BUG if traceback or outcome.stage_code is not None else MISTAKE


def _why(said: str) -> str:
    return "unchanged" if "change" in said else "from the cache"
