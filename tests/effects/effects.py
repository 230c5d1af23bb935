"""All effects that the battery runs over: the library's, plug-ins', and a user's own file."""

import atexit
import shutil
import tempfile
from functools import cache
from pathlib import Path

import spirob.effects
from spirob.effects import Effect, all_effects, load_file
from spirob.plant import Plant, Rig

TEMPLATE = Path(spirob.effects.__file__).parent / "template.py.txt"


@cache
def own_effect() -> type[Effect]:
    """The template as a user would save it, under a name of his own."""
    folder = Path(tempfile.mkdtemp(prefix="own_effect_"))  # kept: compiling reads the source
    atexit.register(shutil.rmtree, folder)
    return load_file(Path(shutil.copy(TEMPLATE, folder / "warming_seal.py")))["warming_seal"]


EFFECTS = {**all_effects(), "warming_seal": own_effect()}


@cache
def whole() -> Plant:
    """One model with every effect of the library: one compilation serves them all."""
    return Plant(Rig(), list(all_effects().values()))
