"""A log of any kind that is damaged is a table or a sentence: no crash, no hang, no gigabyte."""

import bz2
import shutil
import zipfile

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.rosbag1 import Writer as Writer1
from rosbags.typesys import Stores, get_typestore

from spirob.errors import SpirobError
from spirob.logs.readers import read_table
from tests.logs.readers.same_log import KINDS

FLIPS = st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255)), max_size=6)


@pytest.fixture(scope="module")
def wholes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    return folder, {kind: write(folder) for kind, write in KINDS.items()}


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_damaged_is_a_table_or_a_sentence(kind, wholes):
    folder, logs = wholes
    log = logs[kind]
    file = log.path if log.path.is_file() else next(log.path.glob("*bag*"))
    whole = file.read_bytes()
    path = folder / f"damaged{file.suffix}"

    @settings(max_examples=25, deadline=None)
    @given(
        flips=FLIPS,
        near=st.sampled_from([1.0, 0.1, 0.01]),  # headers and footers hold the lengths
        back=st.booleans(),
        end=st.one_of(st.just(1.0), st.floats(0, 1)),
    )
    def holds(flips, near, back, end):
        content = bytearray(whole[: int(end * len(whole))])
        for at, mask in flips:
            place = int(at * near * len(content))
            if content:
                content[-1 - place if back else place] ^= mask
        path.write_bytes(content)
        try:
            table = read_table(path, log.names, log.dbc)
        except SpirobError as error:
            assert len(str(error)) < 1000
            assert str(error).startswith((str(path), path.name, str(log.dbc)))
        else:
            assert len({len(values) for values in table.columns.values()}) <= 1

    holds()


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "ros 2 mcap"])
def test_a_name_that_lies_is_a_table_or_a_sentence(kind, wholes):
    """Each kind under the name of all others."""
    folder, logs = wholes
    file = logs[kind].path if logs[kind].path.is_file() else next(logs[kind].path.glob("*.db3"))
    for other in {path.suffix for path in folder.glob("a.*")} - {".dbc"}:
        path = folder / f"lie{other}"
        shutil.copy(file, path)
        try:
            read_table(path, ["time", "q"], logs["candump"].dbc)
        except SpirobError as error:
            assert len(str(error)) < 1000


def test_small_files_that_unpack_to_gigabytes_are_refused(tmp_path):
    zeros = np.zeros(2**20)
    with zipfile.ZipFile(tmp_path / "many.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        for k in range(40):
            with archive.open(f"c{k}.npy", "w") as member:
                np.lib.format.write_array(member, zeros)
    with h5py.File(tmp_path / "many.h5", "w") as file:
        for k in range(40):
            file.create_dataset(f"c{k}", data=zeros, compression="gzip", compression_opts=1)
    lines = "\n".join(["t;q", *(["1;2"] * 4)]) + "\n" * 2**22
    (tmp_path / "blank.csv").write_text(lines)
    (tmp_path / "nested.json").write_text("[" + "[]," * 2**21 + "[]]")
    for name in ("many.npz", "many.h5", "nested.json"):
        with pytest.raises(SpirobError, match=name):
            read_table(tmp_path / name)
    assert read_table(tmp_path / "blank.csv").column("q").tolist() == [2.0] * 4


def test_a_chunk_of_a_bag_that_unpacks_to_gigabytes_is_refused(tmp_path):
    store, kind = get_typestore(Stores.ROS1_NOETIC), "std_msgs/msg/Float64"
    bag = Writer1(tmp_path / "a.bag")
    bag.set_compression(Writer1.CompressionFormat.BZ2)
    with bag:
        topic = bag.add_connection("/x", kind, typestore=store)
        for k, value in enumerate(np.random.default_rng(1).random(12_000)):
            bag.write(topic, k, store.serialize_ros1(store.types[kind](value), kind))
    whole = (tmp_path / "a.bag").read_bytes()
    at = whole.index(b"BZh9")
    size = int.from_bytes(whole[at - 4 : at], "little")
    bomb = bz2.compress(bytes(2**26)) * 20
    assert len(bomb) < size
    (tmp_path / "a.bag").write_bytes(whole[:at] + bomb.ljust(size, b"\0") + whole[at + size :])
    with pytest.raises(SpirobError, match="more than 1024 MiB"):
        read_table(tmp_path / "a.bag", ["/x.data"])
