"""Tell the diameter of a wrapped object, with an interval, from the log of its wrap.

A wrap unlike those of the training is refused in a sentence.
"""

import argparse

from spirob.errors import DataError

HELP = "tell the size of a wrapped object from a log"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("logs", nargs="+", metavar="LOG.mcap", help="logs of wraps")
    parser.add_argument(
        "--model",
        default="data/models/size.skops",
        metavar="FILE",
        help="trained model, with FILE.sha256 beside it (default: %(default)s)",
    )
    parser.add_argument("--motor", choices=("left", "right"), default="left", help="that wound in")
    parser.add_argument(
        "--confidence", type=float, default=0.9, metavar="P", help="of the interval (%(default)s)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print one line for each log; the first wrap without a size ends it."""
    import pandas as pd

    from spirob.logs import read_log
    from spirob.perceive.features import extract
    from spirob.perceive.interval import estimate
    from spirob.perceive.model_file import load_model

    model = load_model(arguments.model)
    for log in arguments.logs:
        trace = read_log(log)
        features = extract(trace, arguments.motor, model.features)
        (found,) = estimate(model, pd.DataFrame([features], index=[log]), arguments.confidence)
        if found.refusal:
            raise DataError(found.refusal)
        print(
            f"{log}: {1e3 * found.diameter:.1f} mm, {100 * arguments.confidence:g} % interval "
            f"{1e3 * found.low:.1f} to {1e3 * found.high:.1f} mm"
        )
    return 0
