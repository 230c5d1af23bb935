"""Stage `trial`: a few robots with something hidden, named blind, and how often the name was right.

The whole test takes hours and is played by `spirob trial`; this one shows that the way is open.
"""

from pathlib import Path

from pipeline.diagnose import settings_of
from pipeline.stage import entry, public_config, tell, workers, write_json
from spirob.campaign.arm.case import quickly
from spirob.campaign.arm.rates import rates
from spirob.campaign.arm.running import cases, play


def stage(root: Path) -> None:
    """Play the configured cases and write their rates."""
    config = public_config(root)
    chosen, settings = config.trial, quickly(settings_of(config))
    seeds = range(*chosen.seeds)
    table = root / "data/trial.jsonl"
    picked = cases(chosen.kinds, seeds, chosen.nulls, chosen.without, build=chosen.build)
    results = play(picked, table, workers(), settings, tell, chosen.scheduler)
    write_json(root / "reports/metrics/trial.json", rates(results))


if __name__ == "__main__":
    entry("trial", stage, __doc__)
