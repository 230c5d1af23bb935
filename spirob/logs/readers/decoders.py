"""Bytes of a message to a message: JSON, protobuf by its schema, ROS 1 and ROS 2 by theirs."""

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from spirob.errors import DataError

Decode = Callable[[bytes], Any]
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*")
IDL = "=" * 80 + "\n"  # between the parts of a definition in OMG's language
LARGEST = 100_000  # elements of an array of fixed size


@dataclass(frozen=True)
class Encoding:
    """How the messages of a topic are written down.

    message, definition  "json", "protobuf", "cdr", "ros1";  "ros2msg", "ros2idl", "ros1msg"
    kind, schema         name of the type of message, and its definition
    """

    message: str
    definition: str = ""
    kind: str = ""
    schema: bytes = b""


def decoder(where: str, topic: str, encoding: Encoding) -> Decode:
    """What turns the bytes of one message of a topic into it.

    Raises DataError where the encoding is not known or its definition is broken.
    """
    if encoding.message == "json":
        return json.loads
    try:
        if encoding.message == "protobuf":
            return _protobuf(encoding)
        if encoding.message in ("cdr", "ros1"):
            return _ros(encoding)
    except Exception as error:  # a definition may be anything, and the libraries raise anything
        said = " ".join(str(error).split())[:200] or type(error).__name__
        raise DataError(f"{where}: the definition of {encoding.kind} is broken: {said}") from None
    raise DataError(
        f"{where}: {topic} is encoded as '{encoding.message}'; read are json, protobuf, cdr, ros1"
    )


def _protobuf(encoding: Encoding) -> Decode:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    files = descriptor_pb2.FileDescriptorSet.FromString(encoding.schema)
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    kind = message_factory.GetMessageClass(pool.FindMessageTypeByName(encoding.kind))
    return lambda data: kind.FromString(data)


def _ros(encoding: Encoding) -> Decode:
    from rosbags.typesys import Stores, get_typestore
    from rosbags.typesys.msg import normalize_msgtype

    kind = normalize_msgtype(encoding.kind)
    if encoding.schema.strip():
        store = get_typestore(Stores.EMPTY)
        store.register(_types(kind, encoding))
    else:  # bags of older ROS 2 hold no definitions
        store = get_typestore(Stores.LATEST)
    if kind not in store.types:
        raise ValueError("the bag does not hold it; record it with ROS 2 Iron or later")
    if encoding.message == "cdr":
        return lambda data: store.deserialize_cdr(data, kind)
    return lambda data: store.deserialize_ros1(data, kind)


def _types(kind: str, encoding: Encoding) -> Any:
    """The types of a definition, which become code: no name and no size that it may not hold."""
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    text = encoding.schema.decode()
    types: Any = {}
    if encoding.definition != "ros2idl":
        types = get_types_from_msg(text, kind)
    elif text.startswith(f"{IDL}IDL: "):
        for part in text.split(IDL)[1:]:
            types |= get_types_from_idl(part.partition("\n")[2])
    else:
        types = get_types_from_idl(text)
    for name, (_, fields) in types.items():
        if not NAME.fullmatch(name) or not all(NAME.fullmatch(field) for field, _ in fields):
            raise ValueError("a name in it is none")
        if any(_sizes(about) > LARGEST for _, about in fields):
            raise ValueError(f"an array of more than {LARGEST} elements")
    return {name: ([], fields) for name, (_, fields) in types.items()}


def _sizes(about: Any) -> int:
    """The size of an array of fixed size, 0 of any other field."""
    inner = about[1]
    return inner[1] if isinstance(inner[0], tuple) else 0
