"""The number at one place of the messages of a topic: `joints[0].position`, `position[elbow]`.

A message is made of dicts or records (of ROS, of protobuf) and lists.  An index may be a word where
a list of names as long as the array stands beside it or above, as in ROS's JointState.  The index
of an array of one may be left out.  A stamp, of seconds and nanoseconds, is a number in seconds.
"""

import dataclasses
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

_STEP = re.compile(r"\.?([^.\[\]]+)|\[([^\[\]]{1,100})\]")
STAMPS = [("sec", "nanosec"), ("secs", "nsecs"), ("sec", "nsec"), ("seconds", "nanos")]
LONGEST = 64  # elements of an array that are listed
DEEPEST = 12  # structures within structures


class Field:
    """The number at one place of every message of a topic."""

    def __init__(self, place: str) -> None:
        self.is_time = False
        self._steps: list[tuple[str, int | None]] | None = []
        self._first: int | None = None
        at = 0
        while at < len(place) and self._steps is not None:
            step = _STEP.match(place, at)
            if step is None or (step[1] or "").startswith("_"):
                self._steps = None
                return
            index = int(step[2]) if step[2] and step[2].isdecimal() else None
            self._steps.append((step[1], -1) if step[1] else (step[2], index))
            at = step.end()

    def at(self, message: Any) -> Any:
        """What is there; None where nothing is."""
        above: list[Any] = []
        for name, index in self._steps or ():
            above.append(message)
            if index == -1:
                message = _member(message, name)
            else:
                message = _element(message, name, index, above)
        if self._steps is None or message is None:
            return None
        return message[0] if _is_list(message) and len(message) == 1 else message

    def of(self, message: Any) -> float:
        """The number; not a number where there is none.  Stamps count from the first."""
        message = self.at(message)
        stamp = _stamp(message)
        if stamp is None:
            return _number(message)
        self.is_time = True
        self._first = stamp if self._first is None else self._first
        return (stamp - self._first) / 1e9


def listed(message: Any, place: str, above: Sequence[Any] = ()) -> Iterator[str]:
    """The places of all numbers in a message, each with `place` before it."""
    if len(above) > DEEPEST:
        return
    if _is_list(message):
        labels = _labels(len(message), above)
        if len(message) == 1:
            yield from listed(message[0], place, (*above, message))
        else:
            for k in range(min(len(message), LONGEST)):
                label = labels[k] if labels else k
                yield from listed(message[k], f"{place}[{label}]", (*above, message))
    elif _stamp(message) is not None or not np.isnan(_number(message, nan=0.0)):
        yield place
    else:
        for name, inner in _members(message).items():
            yield from listed(inner, f"{place}.{name}", (*above, message))


def _member(message: Any, name: str) -> Any:
    if isinstance(message, Mapping):
        return message.get(name)
    return getattr(message, name, None)


def _element(message: Any, name: str, index: int | None, above: Sequence[Any]) -> Any:
    if not _is_list(message):
        return message.get(name) if isinstance(message, Mapping) else None
    if index is None:
        labels = _labels(len(message), above)
        index = labels.index(name) if labels and name in labels else None
    return message[index] if index is not None and index < len(message) else None


def _members(message: Any) -> dict[str, Any]:
    if isinstance(message, Mapping):
        return {str(name): inner for name, inner in message.items()}
    if dataclasses.is_dataclass(message):
        return {f.name: getattr(message, f.name) for f in dataclasses.fields(message)}
    kind = getattr(message, "DESCRIPTOR", None)
    return {f.name: getattr(message, f.name) for f in kind.fields} if kind else {}


def _labels(count: int, above: Sequence[Any]) -> list[str] | None:
    """A list of `count` different names, the nearest one above."""
    for message in reversed(above):
        for inner in _members(message).values():
            if _is_list(inner) and len(inner) == count and all(isinstance(n, str) for n in inner):
                names = list(inner)
                if len(set(names)) == count:
                    return names
    return None


def _is_list(message: Any) -> bool:
    if isinstance(message, str | bytes | Mapping):
        return False
    return hasattr(message, "__getitem__") and hasattr(message, "__len__")


def _stamp(message: Any) -> int | None:
    """Nanoseconds of a stamp."""
    for seconds, nanos in STAMPS:
        whole, part = _member(message, seconds), _member(message, nanos)
        if isinstance(whole, int) and isinstance(part, int):
            return whole * 10**9 + part
    return None


def _number(message: Any, nan: float = np.nan) -> float:
    if not isinstance(message, int | float | np.number):
        return np.nan
    try:
        found = float(message)
    except OverflowError:
        return np.inf
    return nan if np.isnan(found) else found
