"""Property tests draw the same examples in every run; HYPOTHESIS_PROFILE=drawn draws others."""

import os

from hypothesis import settings

settings.register_profile("same", derandomize=True, database=None)
settings.register_profile("drawn")
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))
