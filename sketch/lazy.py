"""Attributes that are made when they are first asked for."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

__all__ = ["lazy"]

if TYPE_CHECKING or sys.version_info >= (3, 12):
    from functools import cached_property as lazy
else:

    class lazy:
        """As `functools.cached_property`, without the lock that it had before Python 3.12: that takes longer than
        most of what is made, and a page asks for thousands."""

        def __init__(self, make: Callable[[Any], Any]) -> None:
            self.make, self.__doc__ = make, make.__doc__

        def __set_name__(self, owner: type, name: str) -> None:
            self.name = name

        def __get__(self, whole: Any, owner: type | None = None) -> Any:
            if whole is None:
                return self
            made = whole.__dict__[self.name] = self.make(whole)
            return made
