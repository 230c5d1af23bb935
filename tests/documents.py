"""The least that a diagnosis says, for tests of those who read one."""

from typing import Any

from spirob.diagnosis.schema import checked


def document(**said: Any) -> dict[str, Any]:
    """A whole document with what a test says of it."""
    least = {
        "verdict": "named",
        "sentence": "Missing: something.",
        "explanation": "",
        "doubts": [],
        "next_experiment": "",
        "effects": [],
        "evidence": [],
        "candidates": [],
        "ladder": [],
        "left": {"share": 0.0},
        "noise_floor": 0.0,
        "atlas": [],
        "atlas_sentences": [],
        "atlas_orders": [],
        "atlas_lateness": {"delay_ms": 0.0, "delay_share": 0.0, "command_share": None},
        "unit": "A",
    }
    return checked({**least, **said})
