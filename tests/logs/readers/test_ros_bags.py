"""Bags of ROS 1 and ROS 2: nested messages, several topics, types of a laboratory's own."""

import sqlite3

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from spirob.errors import DataError, MissingChannel, NothingLeft
from spirob.logs.readers import read_table
from spirob.logs.readers.decoders import Encoding, decoder
from tests.logs.readers.same_log import KINDS, N, Q

OWN = "uint8 id\nfloat32[3] phase\nfloat64[] load\ngeometry_msgs/Pose pose\nstring label\n"
POSE = "geometry_msgs/msg/Pose"
KIND = "lab_msgs/msg/Drive"
COUNT = 40


def drives(store):
    """The same numbers as a message of the laboratory's own type."""
    store.register(get_types_from_msg(OWN, KIND))
    point, turn = (store.types[f"geometry_msgs/msg/{name}"] for name in ("Point", "Quaternion"))
    for k in range(COUNT):
        pose = store.types[POSE](point(float(k), 0.0, -k), turn(0.0, 0.0, 0.0, 1.0))
        phase, load = np.array([k, 0, -k], np.float32), np.array([0.5 * k])
        yield k * 1_000_000, store.types[KIND](7, phase, load, pose, "left")


def bag1(path, packed=None):
    store = get_typestore(Stores.ROS1_NOETIC)
    bag = Writer1(path)
    if packed is not None:
        bag.set_compression(packed)
    with bag:
        messages = list(drives(store))
        topic = bag.add_connection("/drive", KIND, typestore=store)
        for stamp, message in messages:
            bag.write(topic, stamp, store.serialize_ros1(message, KIND))
    return path


def bag2(path, plugin=StoragePlugin.SQLITE3, packed=False):
    store = get_typestore(Stores.LATEST)
    bag = Writer2(path, version=9, storage_plugin=plugin)
    if packed:
        bag.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
    with bag:
        messages = list(drives(store))
        topic = bag.add_connection("/drive", KIND, typestore=store)
        for stamp, message in messages:
            bag.write(topic, stamp, store.serialize_cdr(message, KIND))
    return path


WRITERS = {
    "ros 1": lambda folder: bag1(folder / "a.bag"),
    "ros 1 lz4": lambda folder: bag1(folder / "a.bag", Writer1.CompressionFormat.LZ4),
    "ros 1 bz2": lambda folder: bag1(folder / "a.bag", Writer1.CompressionFormat.BZ2),
    "db3": lambda folder: bag2(folder / "bag"),
    "packed": lambda folder: bag2(folder / "bag", packed=True),
    "one db3": lambda folder: bag2(folder / "bag") / "bag.db3",
    "mcap": lambda folder: bag2(folder / "bag", StoragePlugin.MCAP),
}


@pytest.mark.parametrize("kind", WRITERS)
def test_any_field_of_any_message_is_a_column(kind, tmp_path):
    path = WRITERS[kind](tmp_path)
    k = np.arange(COUNT)
    expected = {
        "time": k * 1e-3,
        "/drive.id": np.full(COUNT, 7),
        "/drive.phase[2]": -k,
        "/drive.load": 0.5 * k,
        "/drive.pose.position.x": k,
        "/drive.pose.orientation.w": np.ones(COUNT),
    }
    table = read_table(path, list(expected))
    for name, values in expected.items():
        np.testing.assert_allclose(table.column(name), values, rtol=1e-12)
    every = read_table(path)
    assert {*expected, "/drive.pose.position.z", "/drive.phase[0]"} <= set(every.columns)
    with pytest.raises(MissingChannel, match=r"present: .*/drive\.phase\[0\], /drive\.phase\[1\]"):
        read_table(path, ["/drive.phase"]).column("/drive.phase")
    with pytest.raises(DataError, match=r"'/drive\.label' holds text such as 'left'"):
        read_table(path, ["/drive.label"]).column("/drive.label")


def test_a_bag_of_several_files_is_one_log(tmp_path):
    log = KINDS["ros 2 db3"](tmp_path)
    first = next(log.path.glob("*.db3"))
    second = first.with_name("more.db3")
    second.write_bytes(first.read_bytes())
    for path, half in ((first, "<="), (second, ">")):
        with sqlite3.connect(path) as base:
            base.execute(f"DELETE FROM messages WHERE NOT id {half} {N // 2}")
    table = read_table(log.path, log.names)
    np.testing.assert_allclose(table.column(log.q), Q, atol=1e-9)


def test_an_older_bag_without_definitions_has_the_usual_types_alone(tmp_path):
    log = KINDS["ros 2 db3"](tmp_path)
    for path, names in ((log.path, log.names), (bag2(tmp_path / "own"), ["/drive.id"])):
        with sqlite3.connect(next(path.glob("*.db3"))) as base:
            base.execute("DROP TABLE message_definitions")
        if path == log.path:
            np.testing.assert_allclose(read_table(path, names).column(log.q), Q, atol=1e-9)
        else:
            with pytest.raises(DataError, match="lab_msgs/msg/Drive is broken: the bag does not"):
                read_table(path, names)


def test_a_bag_without_messages_is_told_as_empty(tmp_path):
    path = bag2(tmp_path / "bag")
    with sqlite3.connect(next(path.glob("*.db3"))) as base:
        base.execute("DELETE FROM messages")
    with pytest.raises(NothingLeft, match="bag: holds no message"):
        read_table(path, ["/drive.id"])


def test_files_that_are_packed_are_told_how_to_unpack(tmp_path):
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag/bag_0.db3.zstd").write_bytes(b"\x28\xb5\x2f\xfd")
    with pytest.raises(DataError, match=r"zstd -d bag_0\.db3\.zstd"):
        read_table(tmp_path / "bag")


def test_a_bag_that_breaks_off_is_refused(tmp_path):
    path = bag1(tmp_path / "a.bag")
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(DataError, match="this is no readable bag of ROS 1"):
        read_table(path, ["/drive.id"])


@pytest.mark.parametrize(
    "definition",
    [
        "float64 __class__\n",
        "float64[1000000000] x\n",
        "float64 x\n" + "=" * 80 + "\nMSG: a/b\nstring s='\\'); raise SystemExit  #'\n",
        "lab_msgs/Drive again\n",
        "nobody/Knows x\n",
        "\0\0\0",
        "float64 " + "x" * 100_000,
    ],
)
def test_a_definition_that_is_none_is_told_or_harmless(definition):
    encoding = Encoding("cdr", "ros2msg", "lab_msgs/msg/Drive", definition.encode())
    try:
        decode = decoder("a.mcap", "/drive", encoding)
        decode(bytes([0, 1, 0, 0]) + bytes(16))
    except Exception as error:
        assert str(error)
