"""C99: a header and a source that a drive or a controller compiles in."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spirob.export.corrected import Corrected

HOLDS = "the feed-forward (compensate), the forward friction terms and the readings, of every effect"
LACKS = "the body of a model file: its load is given by the caller (state.carried)"
LOSSY = False
PLAYER = "c"


def files(model: "Corrected") -> dict[str, str]:
    """Name of each file -> its text."""
    from spirob.export.code import c_files

    return c_files(model)
