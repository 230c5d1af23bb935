"""Property tests draw the same examples in every run; HYPOTHESIS_PROFILE=drawn draws others.

Files are handed out in their order, the longest of all first: who begins it last is waited for.
"""

import os

from hypothesis import settings

settings.register_profile("same", derandomize=True, database=None)
settings.register_profile("drawn")
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))

LONGEST = "test_whole_way.py"  # a tenth of the whole


def pytest_collection_modifyitems(items):
    """Begin with the longest file."""
    items.sort(key=lambda item: item.path.name != LONGEST)
