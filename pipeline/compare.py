"""Stage `compare`: the identified model against every trial that it was not fitted to."""

from pathlib import Path

import numpy as np

from pipeline.model import plant, residual
from pipeline.stage import entry, public_config, read_json, tell, write_json
from spirob.diagnosis.compare import CHANNELS, compare


def stage(root: Path) -> None:
    """Score current, displacement and velocity, trial by trial and on average."""
    config = public_config(root)
    changes = read_json(root / "data/identified/base.json", "identify")["changes"]
    model = plant(config)
    entries = []
    for role in ("validate", "heldout"):
        entries += compare(residual(root, config, model, role), changes)
    write_json(root / "data/compare/compare.json", {"trials": entries})
    heldout = [t for t in entries if t["role"] == "heldout"]
    figures: dict[str, dict[str, float | str]] = {}
    for channel, unit in CHANNELS.items():
        # a commanded current says nothing: its motor shows its load in its motion
        motors = [m for t in heldout for m in t["motors"].values()]
        scored = [m[channel] for m in motors if m["driven"] or channel != "current"]
        means = {k: float(f"{np.mean([s[k] for s in scored]):.9g}") for k in ("mae", "rmse", "r2")}
        figures[channel] = {**means, "unit": unit}
    write_json(root / "reports/metrics/compare.json", figures)
    tell(f"held-out current RMSE {1e3 * float(figures['current']['rmse']):.1f} mA")


if __name__ == "__main__":
    entry("compare", stage, __doc__)
