"""A trained model on disk, beside the SHA-256 of its bytes.

joblib files are pickles: loading one runs what it says.  So the bytes are compared with the hash
file first, or with a hash the caller already knows, and nothing of a file that differs is run.
"""

import hashlib
import io
import os
import re
from pathlib import Path

from spirob.errors import DataError
from spirob.perceive.size import SizeModel

HASH_SUFFIX = ".sha256"


def save_model(model: SizeModel, path: Path | str) -> str:
    """Write the model and `<path>.sha256`, each in one go; returns the hash in hex."""
    import joblib

    path = Path(path)
    buffer = io.BytesIO()
    joblib.dump(model, buffer)
    digest = hashlib.sha256(buffer.getvalue()).hexdigest()
    path.parent.mkdir(parents=True, exist_ok=True)
    _replace(path, buffer.getvalue())
    _replace(hash_file(path), f"{digest}  {path.name}\n".encode())
    return digest


def load_model(path: Path | str, expected: str | None = None) -> SizeModel:
    """Read a model whose bytes have the expected hash.

    expected  hash in hex from a source that is trusted more than the folder; where None, the one
              in `<path>.sha256`, which guards against damage and mix-ups
    Raises DataError where a file is missing, its hash differs, or it holds something else.
    """
    import joblib

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
    model = joblib.load(io.BytesIO(content))
    if not isinstance(model, SizeModel):
        raise DataError(f"{path}: it holds a {type(model).__name__}, not a size model")
    return model


def hash_file(path: Path | str) -> Path:
    """Where the hash of a model file stands."""
    return Path(f"{path}{HASH_SUFFIX}")


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error


def _replace(path: Path, content: bytes) -> None:
    part = path.with_name(path.name + ".part")
    part.write_bytes(content)
    os.replace(part, path)
