"""What was reckoned before, found again by what it was reckoned from."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, TypeVar

__all__ = ["Kept"]

T = TypeVar("T")

LEAST = 1000  # results that are kept in any case


class Kept:
    """The results of functions, kept from one reading of a page to the next.

    A result is found by the function and all that it was given. So it never is out of date: what lies around a thing is
    given to the function that reckons what that means for it, and where it changes, something else is given.
    What was not asked for in the last two readings is forgotten by and by.
    """

    def __init__(self) -> None:
        self._known: dict[Any, list[Any]] = {}  # the reading that it was last asked for in, and the result
        self._reading, self._most = 0, LEAST
        self.made = 0  # results that were not known

    def __call__(self, make: Callable[..., T], *given: Hashable) -> T:
        """What a function makes of what it is given, and of nothing else; the result is never changed."""
        return self._found((make, *given), make, given)

    def through(self, make: Callable[..., T], *given: Hashable) -> T:
        """Likewise of a function that keeps what it makes on the way, and so is given this first."""
        return self._found((make, *given), make, (self, *given))

    def _found(self, key: Hashable, make: Callable[..., T], given: tuple[Any, ...]) -> T:
        there = self._known.get(key)
        if there is None:
            there = self._known[key] = [0, make(*given)]
            self.made += 1
        there[0] = self._reading
        result: T = there[1]
        return result

    def forget(self) -> None:
        """Another reading begins: forget what was not asked for in the last two, once that is much."""
        if len(self._known) > self._most:
            self._known = {k: there for k, there in self._known.items() if there[0] >= self._reading - 1}
            self._most = max(LEAST, 2 * len(self._known))
        self._reading += 1
