"""One file per physical effect; see `effects.effect` for what such a file declares."""

from spirob.effects.discovery import all_effects, find_effects, load_file
from spirob.effects.effect import Effect

__all__ = ["Effect", "all_effects", "find_effects", "load_file"]
