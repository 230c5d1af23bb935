"""Stage `decode`: every MCAP log becomes one Parquet file in SI units."""

from pathlib import Path

from joblib import Parallel, delayed

from pipeline.stage import entry, tell, workers
from spirob.ending import end_with_parent
from spirob.errors import MissingLog
from spirob.logs import read_log, write_parquet


def stage(root: Path) -> None:
    """Decode all logs of data/raw."""
    logs = sorted((root / "data/raw").glob("*.mcap"))
    if not logs:
        raise MissingLog(f"{root / 'data/raw'} holds no log; the stage 'collect' writes them")
    out = root / "data/traces"
    jobs = (delayed(_decode)(log, out / f"{log.stem}.parquet") for log in logs)
    Parallel(n_jobs=workers(), initializer=end_with_parent)(jobs)
    tell(f"decoded {len(logs)} logs")


def _decode(log: Path, out: Path) -> None:
    write_parquet(read_log(log), out)


if __name__ == "__main__":
    entry("decode", stage, __doc__)
