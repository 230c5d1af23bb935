"""The published rates are those of the published cases, robot by robot."""

import json
from pathlib import Path

import pytest

from spirob.campaign.arm.rates import rates
from spirob.campaign.arm.running import known

ROOT = Path(__file__).parents[3]


def test_the_published_rates_follow_from_the_published_cases():
    found = rates(known(ROOT / "reports/trial/cases.jsonl"))
    told = json.loads((ROOT / "reports/metrics/trial_full.json").read_text())
    for name, value in told.items():
        if isinstance(value, dict) and "value" in value:
            assert found[name]["value"] == pytest.approx(value["value"], abs=1e-12), name
            assert found[name]["n"] == value["n"], name
    assert found["cases"] == told["cases"]
    assert json.loads(json.dumps(found["confusion"])) == told["confusion"]
