"""What all stages share: the public configuration, plain files, and errors as sentences."""

import argparse
import gc
import json
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import yaml

from pipeline.schema import Config, validated
from spirob.ending import stop_as_by_hand
from spirob.errors import DataError, MissingLog, SpirobError
from spirob.files import write_text
from spirob.logs.trace import Trace, read_parquet

PUBLIC = Path("data/config/config.yaml")
HIDDEN = Path("data/config/hidden.yaml")
ASKED = Path("data/asked")  # logs of trials that decide between rivals
FAILED, INTERRUPTED = 2, 130


def entry(name: str, stage: Callable[[Path], None], about: str | None) -> None:
    """What `python -m pipeline.NAME` does: run the stage, or say with --help what it is about."""
    gc.freeze()  # what is imported stays to the end: to look through it again takes half a second
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(
        prog=f"python -m pipeline.{name}", description=about, formatter_class=raw
    )
    parser.parse_args()
    run(name, stage)


def run(name: str, stage: Callable[[Path], None]) -> None:
    """Run a stage in the current folder; a user's mistake becomes one sentence and code 2."""
    stop_as_by_hand()
    try:
        stage(Path("."))
    except SpirobError as error:
        print(f"{name}: {error}", file=sys.stderr)
        sys.exit(FAILED)
    except KeyboardInterrupt:
        print(f"{name}: interrupted; run `dvc repro` to go on", file=sys.stderr)
        sys.exit(INTERRUPTED)


def tell(text: str) -> None:
    """One plain line of progress."""
    print(text, flush=True)


def workers() -> int:
    """Threads or processes to use: the cores that this process may run on.

    Fewer where a container has a share of them, or `LOKY_MAX_CPU_COUNT` says so.
    """
    from joblib import cpu_count  # a stage that does all by itself needs none of it

    return int(cpu_count())


def public_config(root: Path) -> Config:
    """The resolved configuration, without what only the robot knows."""
    return validated(read_yaml(root / PUBLIC, "config"), str(PUBLIC))


def written(path: Path, stage: str) -> Path:
    """The path of what an earlier stage wrote; raises MissingLog where it did not."""
    if not path.exists():
        raise MissingLog(f"{path} is missing; the stage '{stage}' writes it")
    return path


def trace_of(root: Path, name: str) -> Trace:
    """The decoded log of a trial."""
    return read_parquet(written(root / "data/traces" / f"{name}.parquet", "decode"))


def read_yaml(path: Path, stage: str) -> Any:
    """A YAML file that an earlier stage wrote."""
    try:
        return yaml.safe_load(written(path, stage).read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise DataError(f"{path} is not YAML: {' '.join(str(error).split())}") from None


def read_json(path: Path, stage: str) -> Any:
    """A JSON file that an earlier stage wrote."""
    try:
        return json.loads(written(path, stage).read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise DataError(f"{path} is not JSON: {error}") from None


def write_json(path: Path, content: Any) -> None:
    """Write JSON whole or not at all."""
    write_text(path, json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def rounded(values: Mapping[str, float]) -> dict[str, float]:
    """Figures as they are written: with nine digits."""
    return {k: float(f"{v:.9g}") for k, v in values.items()}
