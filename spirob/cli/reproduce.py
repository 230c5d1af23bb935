"""Takes over choices, runs the pipeline as a process of its own (`dvc repro`), follows its stages.

What the pipeline consists of is as dvc.yaml says.  How long each stage took last time is kept in
.dvc/tmp, which is not under version control; it only serves the forecast.
"""

import argparse
import collections
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from spirob.cli import BUG, DONE, MISTAKE, STOPPED
from spirob.cli.project import (
    Kept,
    alone,
    discard_torn,
    find_project,
    read_overrides,
    spelt_out,
    write_overrides,
)
from spirob.errors import ConfigError
from spirob.files import write_text
from spirob.progress import Progress


def add_choices(parser: argparse.ArgumentParser) -> None:
    """Arguments of the commands that run a part of the pipeline."""
    parser.add_argument(
        "choices",
        nargs="*",
        metavar="CHOICE",
        help="KEY=VALUE, such as robot.hidden.effect=cogging, or the name of presets: short",
    )
    parser.add_argument("--defaults", action="store_true", help="forget earlier choices")
    parser.add_argument("--project", metavar="DIR", help="its folder; else the nearest above")
    parser.add_argument("--verbose", action="store_true", help="show what the stages say")


def advance(arguments: argparse.Namespace, target: str | None) -> tuple[int, Path]:
    """Take over the choices and run up to the stage `target`: exit code, and the project's folder.

    Choices of a run that does not come to its end are taken back.
    """
    project = taken_up(arguments)
    stages(project, target)  # a stage that is none is said before anything is changed
    read_overrides(project)  # and so are choices that cannot be read
    with alone(project), Kept(project, chosen(arguments)) as kept:
        if chosen(arguments) is not None:
            gone = [] if arguments.defaults else forgotten(project, arguments.choices)
            write_overrides(project, arguments.choices)
            if gone:
                listed = ", ".join(gone)
                print(f"earlier choices are replaced: {listed}; {AGAIN}", file=sys.stderr)
        code = reproduce(project, target, arguments.verbose).code
        kept.done = code == DONE
    return code, project


def taken_up(arguments: argparse.Namespace) -> Path:
    """The project's folder; names of presets among the choices are spelt out from now on."""
    project = find_project(arguments.project)
    arguments.choices = spelt_out(project, arguments.choices)
    return project


def chosen(arguments: argparse.Namespace) -> list[str] | None:
    """The choices that this command makes; None where it leaves the earlier ones."""
    return list(arguments.choices) if arguments.choices or arguments.defaults else None


def forgotten(project: Path, choices: Sequence[str]) -> list[str]:
    """Earlier choices that these would replace without a word about their keys."""
    named = {_key(choice) for choice in choices}
    return [earlier for earlier in read_overrides(project) if _key(earlier) not in named]


def _key(choice: str) -> str:
    return choice.split("=", 1)[0].lstrip("~+")


AGAIN = "to keep one, give it again on the same line"
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


RUNNING = re.compile(r"^Running stage '(?P<stage>[\w@-]+)'")
IDLE = re.compile(r"^Stage '(?P<stage>[\w@-]+)' (?P<why>didn't change|is cached)")
FAILED = re.compile(
    r"^ERROR: failed to reproduce '(?P<stage>[\w@-]+)'.*exited with (?P<code>-?\d+)"
)
PATIENCE = 10.0  # s for what is interrupted to come to its end
LAST_LINES = 40  # of a failing stage
CHATTER = ("Updating lock", "Generating lock", "To track the changes", "\tgit add", "> ")


@dataclass
class Outcome:
    """How a run ended.

    code    exit code of the run;  failed  stage that failed, and  stage_code  its own exit code
    lines   the last that were said by the stage that ran last
    """

    code: int = DONE
    failed: str = ""
    stage_code: int | None = None
    lines: collections.deque[str] = field(
        default_factory=lambda: collections.deque(maxlen=LAST_LINES)
    )


def reproduce(project: Path, target: str | None = None, verbose: bool = False) -> Outcome:
    """Bring the results up to date, up to the stage `target`.

    verbose  shows what the stages say, too; a stage that fails is always heard
    """
    for name in discard_torn(project):
        print(f"{name} was torn by a kill and is written anew", file=sys.stderr)
    command = [sys.executable, "-m", "spirob.ending", "dvc", "repro"]
    command += [target] if target else []
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
            process_group=0,  # so that all it starts can be stopped with it
        )
        assert process.stdout is not None
        try:
            outcome = follow(process.stdout, progress, verbose)
            process.wait()
        except BaseException:
            _stop(process)
            raise
        finally:
            keep_times(project, progress.taken)
    outcome.code = DONE if process.returncode == 0 else exit_code(outcome)
    if outcome.code != DONE and not verbose:
        print("\n".join(outcome.lines), file=sys.stderr)
    return outcome


def _stop(process: subprocess.Popen[str]) -> None:
    """Interrupt it with all that it started, wait for its end, and insist where it takes long."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        with suppress(ProcessLookupError):
            os.killpg(process.pid, number)
        with suppress(subprocess.TimeoutExpired):
            process.wait(PATIENCE)
            return


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
