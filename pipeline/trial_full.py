"""Stage `trial_full`: the rates of the published trial, of the table that `spirob trial` filled."""

from pathlib import Path

from pipeline.stage import entry, tell, write_json
from spirob.campaign.arm.rates import rates
from spirob.campaign.arm.running import known
from spirob.errors import MissingLog

TABLE, BY = Path("reports/trial/cases.jsonl"), Path("reports/trial/by.txt")


def stage(root: Path) -> None:
    """Rates of all cases of the table, with the diagnosis that they are of."""
    for file in (TABLE, BY):
        if not (root / file).exists():
            raise MissingLog(f"{file} is missing; it is kept in git")
    found = rates(known(root / TABLE))
    by = (root / BY).read_text(encoding="utf-8").strip()
    write_json(root / "reports/metrics/trial_full.json", {"by": by, **found})
    tell(f"{found['cases']} published cases")


if __name__ == "__main__":
    entry("trial_full", stage, __doc__)
