"""`python -m spirob.benchmark --json FILE`: measure, print and write all figures."""

import argparse
import json
from collections.abc import Callable
from pathlib import Path

from spirob.benchmark import diagnosis, feedforward, identification, timing
from spirob.benchmark.timing import TINY, Size

MEASURES: dict[str, Callable[[Size], dict[str, float]]] = {
    "coupled_tick": timing.measure_cycles,
    "threads": timing.measure_threads,
    "decoding": timing.measure_decoding,
    "identification": identification.measure,
    "screening": diagnosis.measure_screening,
    "diagnosis": diagnosis.measure,
    "feedforward": feedforward.measure,
}


def main(arguments: list[str] | None = None) -> dict[str, float]:
    """Run the chosen measures; the figures by key."""
    parser = argparse.ArgumentParser(prog="spirob.benchmark", description=__doc__)
    parser.add_argument("--json", type=Path, help="file to write the figures to")
    parser.add_argument("--only", nargs="*", choices=list(MEASURES), default=list(MEASURES))
    parser.add_argument("--tiny", action="store_true", help="one short round: is it in order?")
    chosen = parser.parse_args(arguments)
    size = TINY if chosen.tiny else Size()
    figures: dict[str, float] = {}
    for name in chosen.only:
        figures |= MEASURES[name](size)
    for key, value in figures.items():
        print(f"{key:36s} {value:.4g}")
    if chosen.json:
        chosen.json.write_text(json.dumps(figures, indent=2) + "\n")
    return figures


if __name__ == "__main__":
    main()
