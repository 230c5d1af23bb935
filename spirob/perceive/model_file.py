"""A trained model on disk, beside the SHA-256 of its bytes.

The format is skops': a zip of plain arrays and of the names of classes, of which only those of
scikit-learn and of `TRUSTED` are made.  Nothing in a file is run.  The hash guards against damage
and mix-ups.
"""

import hashlib
import io
import re
from pathlib import Path
from typing import Any, TypeVar
from zipfile import ZIP_DEFLATED, BadZipFile, ZipFile, ZipInfo

import numpy as np
from sklearn.pipeline import Pipeline

from spirob.errors import DataError
from spirob.files import write_bytes
from spirob.perceive.size import SizeModel

Kind = TypeVar("Kind")
HASH_SUFFIX = ".sha256"
MOST = 256 << 20  # bytes that a file may unpack to; 1200 wraps need some 5 MiB
TRUSTED = (  # beside what skops itself takes for plain
    "sklearn.tree._tree.Tree",  # its links are checked in `_require_trees`
    "spirob.perceive.size.Cut",
    "spirob.perceive.size.MonotoneFeatures",
    "spirob.perceive.size.SizeModel",
    "spirob.perceive.size.SizeSettings",
)


def save_model(model: SizeModel | Pipeline, path: Path | str) -> str:
    """Write the model and `<path>.sha256`, each in one go; returns the hash in hex.

    The same model gives the same bytes.
    """
    import skops.io

    path = Path(path)
    content = _same_bytes(skops.io.dumps(model))
    digest = hashlib.sha256(content).hexdigest()
    write_bytes(path, content)
    write_bytes(hash_file(path), f"{digest}  {path.name}\n".encode())
    return digest


def load_model(path: Path | str, expected: str | None = None) -> SizeModel:
    """A model of sizes; see `load`."""
    return load(path, SizeModel, "a size model", expected)


def load_regions(path: Path | str) -> Pipeline:
    """A classifier of where an arm was pushed; see `load`."""
    return load(path, Pipeline, "a classifier of regions")


def load(path: Path | str, kind: type[Kind], name: str, expected: str | None = None) -> Kind:
    """Read a model whose bytes have the expected hash.

    expected  hash in hex from a source that is trusted more than the folder; where None, the one
              in `<path>.sha256`
    Raises DataError where a file is missing, its hash differs, or it holds something else.
    """
    path = Path(path)
    content = _content(path)
    wanted = expected or _content(hash_file(path)).decode("ascii", "replace").partition(" ")[0]
    wanted = wanted.strip().lower()
    if not re.fullmatch("[0-9a-f]{64}", wanted):
        raise DataError(f"{hash_file(path)}: it holds no SHA-256 hash")
    found = hashlib.sha256(content).hexdigest()
    if found != wanted:
        raise DataError(
            f"{path}: its hash is {found[:12]}…, but {wanted[:12]}… is expected; the file was "
            "changed and is not loaded"
        )
    model = _made(path, content)
    if not isinstance(model, kind):
        raise DataError(f"{path}: it holds a {type(model).__name__}, not {name}")
    return model


def hash_file(path: Path | str) -> Path:
    """Where the hash of a model file stands."""
    return Path(f"{path}{HASH_SUFFIX}")


def _made(path: Path, content: bytes) -> Any:
    import skops.io
    from skops.io.exceptions import UntrustedTypesFoundException

    try:
        with ZipFile(io.BytesIO(content)) as parts:
            if sum(part.file_size for part in parts.infolist()) > MOST:
                raise DataError(f"{path}: it unpacks to more than {MOST >> 20} MiB")
        model = skops.io.loads(content, trusted=TRUSTED)
        if isinstance(model, SizeModel):
            _require_trees(path, model)
        return model
    except DataError:
        raise
    except BadZipFile:
        raise DataError(
            f"{path}: not a model of this program; a stage writes one, 'train' or 'passive'"
        ) from None
    except UntrustedTypesFoundException as error:
        raise DataError(f"{path}: it names what no size model has: {error}") from None
    except Exception as error:  # a foreign schema brings up anything
        raise DataError(f"{path}: damaged ({type(error).__name__}: {error})") from None


def _require_trees(path: Path, model: SizeModel) -> None:
    """Every link of a tree leads on within it: compiled code follows them unchecked."""
    for boosting in model.meta.values():
        for tree in [] if boosting is None else [one.tree_ for one in boosting.estimators_.flat]:
            left, right, here = tree.children_left, tree.children_right, np.arange(tree.node_count)
            leaf = (left == -1) & (right == -1)
            inner = (np.minimum(left, right) > here) & (np.maximum(left, right) < len(here))
            inner &= (tree.feature >= 0) & (tree.feature < tree.n_features)
            if not (leaf | inner).all():
                raise DataError(f"{path}: damaged (a tree's links lead nowhere)")


def _same_bytes(content: bytes) -> bytes:
    """The file without what differs from one run to another: addresses in memory, and dates."""
    numbers: dict[str, str] = {}

    def numbered(found: re.Match[str]) -> str:
        return numbers.setdefault(found[0], str(len(numbers)))

    out = io.BytesIO()
    with ZipFile(io.BytesIO(content)) as given, ZipFile(out, "w") as written:
        schema = given.read("schema.json").decode()
        schema = re.sub(r'(?<="__id__": )\d+|(?<="file": ")\d+(?=\.npy")', numbered, schema)
        for name in given.namelist():
            part = schema.encode() if name == "schema.json" else given.read(name)
            named = re.sub(r"^\d+(?=\.npy$)", numbered, name)
            written.writestr(ZipInfo(named), part, ZIP_DEFLATED)
    return out.getvalue()


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
