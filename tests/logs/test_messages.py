"""The hand-made descriptors and messages are what the official protobuf library makes of them."""

import pytest

from spirob.logs.messages import (
    COMMAND_TOPIC,
    JOINTS_TOPIC,
    RAW_TOPIC,
    SCHEMAS,
    JointPacker,
    double,
    fields,
    integer,
    pack_command,
    pack_frame,
)


def official(topic):
    """The message class that protobuf builds from our descriptor."""
    pytest.importorskip("google.protobuf", reason="protobuf is not installed")
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    name, descriptor = SCHEMAS[topic]
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(descriptor).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))


def test_protobuf_reads_a_can_frame():
    read = official(RAW_TOPIC).FromString(pack_frame(-5, 0x201, b"12345678"))
    assert (read.stamp_ns, read.arbitration_id, read.data) == (-5, 0x201, b"12345678")


def test_protobuf_reads_a_command():
    packed = pack_command(7, (1.0, 2.0), (3.0, 4.0), (5.0, 6.0), (1, 3))
    read = official(COMMAND_TOPIC).FromString(packed)
    assert (read.stamp_ns, read.left_current, read.right_current) == (7, 1.0, 2.0)
    assert (read.left_reference, read.right_reference_rate) == (3.0, 6.0)
    assert (read.left_mode, read.right_mode) == (1, 3)


def test_protobuf_reads_joint_states():
    packed = JointPacker(("left", "right"))(3_000_000_250, (1.0, 2.0), (3.0, 4.0), (5.0, 6.0))
    read = official(JOINTS_TOPIC).FromString(packed)
    assert (read.timestamp.seconds, read.timestamp.nanos) == (3, 250)
    assert [j.name for j in read.joints] == ["left", "right"]
    assert (read.joints[1].position, read.joints[1].velocity, read.joints[1].effort) == (2, 4, 6)
    assert not read.joints[0].HasField("acceleration")


def test_descriptors_name_their_types():
    for topic, (name, descriptor) in SCHEMAS.items():
        assert name.split(".")[1].encode() in descriptor, topic


def test_fields_of_a_packed_frame_read_back():
    found = fields(pack_frame(123, 0x202, b"abc"))
    assert (integer(found[1]), integer(found[2]), found[3]) == (123, 0x202, b"abc")


def test_fields_of_a_packed_command_read_back():
    found = fields(pack_command(9, (1.5, 2.0), (3.0, 4.0), (5.0, 6.0), (1, 3)))
    assert (integer(found[1]), double(found[2]), integer(found[9])) == (9, 1.5, 3)
