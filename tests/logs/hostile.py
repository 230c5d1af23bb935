"""Small files that claim or unpack to gigabytes, read in a process of its own.

python -m tests.logs.hostile FOLDER    prints one line of JSON: what each was refused with, and
                                       the most memory that was held [bytes]
"""

import json
import resource
import struct
import sys
import time
import zlib
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import zstandard
from mcap.records import Chunk
from mcap.stream_reader import StreamReader

from spirob.errors import SpirobError
from spirob.logs import read_log, read_parquet
from spirob.logs.foreign import read_mapping
from spirob.logs.reader import MAGIC, read_bytes
from spirob.logs.readers import read_table
from spirob.logs.recovery import Survey, recover
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on

CHUNK = 60 * 2**20
CHUNKS = 40


def mcap_bomb(path):
    """40 chunks of 60 MiB of frames each, a few hundred kilobytes on disk."""
    message = struct.pack("<BQHIQQ", 5, 22 + 26, 1, 0, 0, 0) + bytes(26)
    head = path.with_name("head.mcap")
    record_on(FakeRobot(), head.parent, 0.2, "head.mcap")
    raw = head.read_bytes()
    content = message * (CHUNK // len(message))
    packed = zstandard.compress(content)
    chunk = struct.pack("<QQQI", 0, 0, len(content), zlib.crc32(content))
    chunk += struct.pack("<I4sQ", 4, b"zstd", len(packed)) + packed
    with head.open("rb") as file:
        records = StreamReader(file, emit_chunks=True).records
        while not isinstance(next(records), Chunk):
            pass
        declared = raw[: file.tell()]
    path.write_bytes(declared + CHUNKS * (struct.pack("<BQ", 6, len(chunk)) + chunk))
    return path


def mcap_of_empty_records(path):
    """A chunk of seven million records of nothing."""
    content = struct.pack("<BQ", 3, 0) * 7_000_000
    packed = zstandard.compress(content)
    chunk = struct.pack("<QQQI", 0, 0, len(content), zlib.crc32(content))
    chunk += struct.pack("<I4sQ", 4, b"zstd", len(packed)) + packed
    path.write_bytes(MAGIC + struct.pack("<BQ", 6, len(chunk)) + chunk)
    return path


def mcap_of_empty_heads(path):
    """Bytes that might begin a record everywhere."""
    path.write_bytes(MAGIC + (b"\x06" + bytes(8)) * 300_000)
    return path


def parquet_bomb(path):
    """100 million equal numbers."""
    table = pa.table({"time_ns": pa.array(np.zeros(2_000_000, np.int64))})
    with pq.ParquetWriter(path, table.schema) as writer:
        for _ in range(50):
            writer.write_table(table)
    return path


def mat_bomb(path):
    """A variable of 400 MiB of nothing."""
    pack, packed = zlib.compressobj(9), b""
    block = bytes(2**20)
    for _ in range(400):
        packed += pack.compress(block)
    packed += pack.flush()
    head = b"MATLAB 5.0".ljust(124) + b"\x00\x01IM"
    path.write_bytes(head + struct.pack("<II", 15, len(packed)) + packed)
    return path


def yaml_bomb(path):
    """Nine levels of ten aliases each: a billion of nothing."""
    lines = ["a: &a [0,0,0,0,0,0,0,0,0,0]"]
    lines += [f"{n}: &{n} [{','.join(['*' + b] * 10)}]" for b, n in zip("abcdefgh", "bcdefghi")]  # noqa: B905
    path.write_text("\n".join(lines))
    return path


def refused(read):
    begin = time.perf_counter()
    try:
        read()
    except SpirobError as error:
        return f"{str(error)[:300]} ({time.perf_counter() - begin:.0f} s)"
    return "accepted"


def peak():
    """Most memory that this process has held [bytes]."""
    status = Path("/proc/self/status")
    if (
        status.exists()
    ):  # what getrusage says begins with what the process held that started this one
        held = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return 1024 * int(held.split()[1])
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def main(folder):
    bomb = mcap_bomb(folder / "bomb.mcap")
    heads = mcap_of_empty_heads(folder / "heads.mcap")
    empty = mcap_of_empty_records(folder / "empty.mcap")
    parquet, mat = parquet_bomb(folder / "bomb.parquet"), mat_bomb(folder / "bomb.mat")
    said = {
        "mcap": refused(lambda: read_log(bomb, torn=True)),
        "survey": str(Survey(read_bytes(bomb)).report.notes[0]),
        "empty": refused(lambda: read_log(empty, torn=True)),
        "empty survey": str(Survey(read_bytes(empty)).report.notes[0]),
        "heads": refused(lambda: recover(heads, folder / "none.mcap")),
        "parquet": refused(lambda: read_parquet(parquet)),
        "parquet import": refused(lambda: read_table(parquet)),
        "mat": refused(lambda: read_table(mat)),
        "yaml": refused(lambda: read_mapping(yaml_bomb(folder / "bomb.yaml"))),
    }
    print(json.dumps({"said": said, "peak": peak()}))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
