"""A cache: what is made once for a key is held as long as there is room."""

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

T = TypeVar("T")


class Cache(Generic[T]):
    """Holds so many things at most; what was asked for longest ago goes first."""

    def __init__(self, most: int):
        self._most = max(1, most)
        self._known: dict[Hashable, T] = {}

    def __call__(self, key: Hashable, made: Callable[[], T]) -> T:
        """The thing of a key, made where none is held."""
        found = self._known.pop(key) if key in self._known else made()
        while len(self._known) >= self._most:
            self._known.pop(next(iter(self._known)))
        self._known[key] = found
        return found

    def items(self) -> list[tuple[Hashable, T]]:
        """Keys and things."""
        return list(self._known.items())
