"""C99: a header and a source that a drive or a controller compiles in."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spirob.export.arm import CorrectedArm
    from spirob.export.corrected import Corrected

HOLDS = (
    "the feed-forward (compensate), the forward friction terms and the readings, of every effect"
)
LACKS = "the body of a model file: its load is given by the caller (state.carried)"
LOSSY = False
PLAYER = "c"


def arm(model: "CorrectedArm") -> dict[str, str]:
    """The same of an arm: a motor each, and the laws of tendons and hinges by themselves."""
    from spirob.export.code import c_files_of_arm

    return c_files_of_arm(model)


def files(model: "Corrected") -> dict[str, str]:
    """Name of each file -> its text."""
    from spirob.export.code import c_files

    return c_files(model)
