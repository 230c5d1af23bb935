"""Stage `decode`: every MCAP log becomes one Parquet file in SI units."""

from pathlib import Path

from joblib import Parallel, delayed

from pipeline.stage import run, tell, workers
from spirob.errors import MissingLog
from spirob.logs import read_log, write_parquet


def stage(root: Path) -> None:
    """Decode all logs of data/raw."""
    logs = sorted((root / "data/raw").glob("*.mcap"))
    if not logs:
        raise MissingLog(f"{root / 'data/raw'} holds no log; the stage 'collect' writes them")
    out = root / "data/traces"
    Parallel(n_jobs=workers())(delayed(_decode)(log, out / f"{log.stem}.parquet") for log in logs)
    tell(f"decoded {len(logs)} logs")


def _decode(log: Path, out: Path) -> None:
    write_parquet(read_log(log), out)


if __name__ == "__main__":
    run("decode", stage)
