"""A generated module lives in the cache, or in one folder that ends with the process."""

import os
import subprocess
import sys

PROGRAM = """
import os, tempfile
from spirob.effects.generated import load
made = [load(f"number = {k}", "sample") for k in range(3)]
assert [m.number for m in made] == [0, 1, 2]
print(len(os.listdir(tempfile.gettempdir())))
"""


def ran(folder, cache):
    (folder / "tmp").mkdir()
    (folder / "tmp").joinpath("other").mkdir()
    env = os.environ | {"XDG_CACHE_HOME": str(cache), "TMPDIR": str(folder / "tmp")}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=env, capture_output=True, text=True, check=True
    )
    return int(done.stdout), os.listdir(folder / "tmp")


def test_what_is_generated_is_kept_in_the_cache(tmp_path):
    assert ran(tmp_path, tmp_path / "cache") == (1, ["other"])
    assert len(list((tmp_path / "cache/spirob").glob("sample_*.py"))) == 3


def test_without_a_cache_one_folder_is_used_and_removed(tmp_path):
    (tmp_path / "cache").write_text("a file, in which no folder can be made")
    assert ran(tmp_path, tmp_path / "cache") == (2, ["other"])
