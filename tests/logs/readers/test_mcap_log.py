"""MCAP: our own by channels, those of others by topic and field; several topics on one time."""

import json

import numpy as np
import pytest
from mcap.writer import CompressionType, Writer

from spirob.errors import DataError, MissingChannel
from spirob.logs import read_log
from spirob.logs.readers import read_table
from tests.logs.readers.same_log import KINDS
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on

BEGIN = 1_700_000_000_000_000_000
STEP = 10_000_000


def written(path, topics, compression=CompressionType.ZSTD, encoding="json", chunk=2**20):
    """topics  name -> messages, each the time [ns] since the beginning and what it says."""
    with path.open("wb") as file:
        writer = Writer(file, compression=compression, chunk_size=chunk)
        writer.start()
        schema = writer.register_schema("Any", "jsonschema", b"{}")
        for topic, messages in topics.items():
            channel = writer.register_channel(topic, encoding, schema)
            for since, said in messages:
                data = said if isinstance(said, bytes) else json.dumps(said).encode()
                writer.add_message(channel, BEGIN + since, data, BEGIN + since)
        writer.finish()
    return path


def states(count=30, names=("hip", "knee")):
    """Messages as ROS's JointState in which each second one has its joints the other way round."""
    found = []
    for k in range(count):
        order = names if k % 2 == 0 else names[::-1]
        numbers = {name: k + 0.25 * j for j, name in enumerate(names)}
        stamp = {"sec": 1_700_000_000 + (k * STEP) // 10**9, "nanosec": (k * STEP) % 10**9}
        said = {"header": {"stamp": stamp}, "name": order, "position": [numbers[n] for n in order]}
        found.append((k * STEP + 1000 * (k % 3), said))
    return found


def test_our_own_logs_give_their_channels(tmp_path):
    path = record_on(FakeRobot(), tmp_path)
    table, trace = read_table(path, ["time", "left.current"]), read_log(path)
    np.testing.assert_array_equal(table.column("left.current"), trace["left.current"])
    np.testing.assert_array_equal(table.column("time"), trace.seconds)
    assert table.units == {"time": "s"}
    topics = read_table(path, ["/joint_states.joints[1].position", "/joint_states.timestamp"])
    assert np.ptp(topics.column("/joint_states.joints[1].position")) > 0
    assert np.ptp(topics.column("/joint_states.timestamp")) > 0.1
    assert topics.units["/joint_states.timestamp"] == "s"


def test_a_joint_has_its_name_wherever_it_stands(tmp_path):
    path = written(tmp_path / "a.mcap", {"/joint_states": states()})
    table = read_table(path, ["/joint_states.position[knee]", "/joint_states.header.stamp"])
    knee = table.column("/joint_states.position[knee]")
    np.testing.assert_array_equal(knee, np.arange(30) + 0.25)
    stamps = table.column("/joint_states.header.stamp")
    np.testing.assert_array_equal(stamps, np.arange(30) * STEP / 1e9)
    assert table.units == {"time": "s", "/joint_states.header.stamp": "s"}
    assert table.column("time")[1] == (STEP + 1000) / 1e9


def test_the_index_of_an_array_of_one_may_be_left_out(tmp_path):
    path = written(tmp_path / "a.mcap", {"/joint_states": states(names=["hip"])})
    for name in ("position", "position[0]", "position[hip]"):
        found = read_table(path, [f"/joint_states.{name}"]).column(f"/joint_states.{name}")
        np.testing.assert_array_equal(found, np.arange(30))


def test_what_is_missing_is_answered_with_names_of_joints(tmp_path):
    path = written(tmp_path / "a.mcap", {"/joint_states": states(), "/mode": [(0, {"on": True})]})
    for name in ("/joint_states.position", "/joint_states.position[ankle]", "/other.x", "q"):
        table = read_table(path, ["time", name])
        assert len(table.column("time"))
        with pytest.raises(MissingChannel) as told:
            table.column(name)
        listed = str(told.value).partition("present: ")[2].split(", ")
        assert {"/joint_states.position[hip]", "/joint_states.position[knee]"} <= set(listed)
        assert {"/joint_states.header.stamp", "/mode.on", "time"} <= set(listed)


def test_slower_topics_are_held_and_what_comes_before_them_is_left_out(tmp_path):
    slow = [(k * STEP + 1, {"a": float(k)}) for k in range(4, 30, 5)]
    path = written(tmp_path / "a.mcap", {"/slow": slow, "/joint_states": states()})
    table = read_table(path, ["time", "/joint_states.position[hip]", "/slow.a"])
    hip = table.column("/joint_states.position[hip]")
    assert hip[0] in (4, 5)
    expected = [
        max(k for k in range(4, 30, 5) if k * STEP < n * STEP + 1000 * (n % 3)) for n in hip
    ]
    np.testing.assert_array_equal(table.column("/slow.a"), expected)
    assert table.column("time")[0] == 0.0
    said = " ".join(table.said)
    assert "/slow is held at its latest value" in said
    assert "messages of /joint_states before the first of all others are left out" in said


def test_messages_without_what_is_wanted_are_left_out(tmp_path):
    both = sorted(
        [*states(), *((t + 500, {"name": ["lamp"], "position": [0.0]}) for t, _ in states(9))],
        key=lambda message: message[0],
    )
    table = read_table(written(tmp_path / "a.mcap", {"/j": both}), ["time", "/j.position[hip]"])
    np.testing.assert_array_equal(table.column("/j.position[hip]"), np.arange(30))
    assert any("9 messages of /j without what is wanted" in sentence for sentence in table.said)


@pytest.mark.parametrize("compression", CompressionType)
def test_every_compression_is_read(tmp_path, compression):
    path = written(tmp_path / "a.mcap", {"/joint_states": states()}, compression)
    assert len(read_table(path, ["/joint_states.position[hip]"]).column("time")) == 30


def test_a_file_that_breaks_off_gives_what_is_whole(tmp_path):
    path = KINDS["ros 2 mcap"](tmp_path).path / "bag_mcap.mcap"
    whole = path.read_bytes()
    path.write_bytes(whole[: int(0.9 * len(whole))])
    table = read_table(path, ["/joint_states.position[0]"])
    assert any("breaks off" in sentence for sentence in table.said)


def test_an_encoding_that_is_not_known_is_told(tmp_path):
    path = written(tmp_path / "a.mcap", {"/j": states()}, encoding="flatbuffer")
    with pytest.raises(DataError, match="/j is encoded as 'flatbuffer'; read are json"):
        read_table(path, ["/j.position[hip]"])


def test_messages_that_are_deep_or_no_messages_are_no_crash(tmp_path):
    deep = 0.0
    for _ in range(400):
        deep = [deep, deep] if _ < 3 else {"a": deep}
    messages = [(0, deep), (1, None), (2, "text"), (3, [1, 2]), (4, {"x": 10**400}), (5, 7)]
    path = written(tmp_path / "a.mcap", {"/j": messages})
    table = read_table(path, ["/j.x"])
    assert table.column("/j.x").tolist() == [np.inf]


def test_texts_in_place_of_numbers_are_told(tmp_path):
    texts = [(k * STEP, {"pos": f"{k}.12", "on": "yes"}) for k in range(30)]
    path = written(tmp_path / "a.mcap", {"/servo": texts})
    for wanted in (["time", "/servo.pos"], ["/servo.pos"]):
        with pytest.raises(DataError, match=r"^a.mcap: '/servo.pos' holds text such as '0.12'"):
            read_table(path, wanted)
    with pytest.raises(DataError, match=r"^a.mcap: no message of /servo holds a number that can"):
        read_table(path, ["time", "/servo.speed"])
    path = written(tmp_path / "b.mcap", {"/servo": [(t, {"n": 1, **m}) for t, m in texts]})
    with pytest.raises(DataError, match=r"'/servo.pos' holds text such as '0.12', not numbers"):
        read_table(path, ["time", "/servo.pos"]).column("/servo.pos")


def test_a_chunk_that_is_lost_is_told_where_no_number_is_left(tmp_path):
    servo = [(k * STEP, {"pos": k}) for k in range(30)]
    topics = {"/said": [(0, {"fills a chunk": "b" * 1000})], "/servo": servo}
    path = written(tmp_path / "a.mcap", topics, CompressionType.NONE, chunk=1000)
    whole = path.read_bytes()
    path.write_bytes(whole.replace(b'"pos"', b'"pso"'))
    with pytest.raises(DataError, match=r"no message of /said holds a number .* is lost: .*check"):
        read_table(path, ["time", "/servo.pos"])


@pytest.mark.parametrize("lost", [1, 2])
def test_a_few_broken_messages_are_left_out(tmp_path, lost):
    messages = [(k * STEP, {"x": float(k)}) for k in range(40)]
    messages[:lost] = [(k * STEP, b'{"x": ') for k in range(lost)]
    table = read_table(written(tmp_path / "a.mcap", {"/j": messages}), ["time", "/j.x"])
    np.testing.assert_array_equal(table.column("/j.x"), np.arange(lost, 40))
    assert f"a.mcap: {lost} messages of /j are broken and left out." in table.said
    assert "/j.x" in read_table(tmp_path / "a.mcap").columns


def test_many_broken_messages_are_refused(tmp_path):
    messages = [(k * STEP, {"x": k} if k % 10 else b"{") for k in range(40)]
    with pytest.raises(DataError, match="a message of /j is broken: Expecting"):
        read_table(written(tmp_path / "a.mcap", {"/j": messages}), ["time", "/j.x"])
