"""Heads of arrows that other programs draw by themselves: a file has the shaft alone."""

from __future__ import annotations

import math

from sketch.typing import Point

__all__ = ["head"]

LENGTH = 30.0  # of a barb [pixels]
SPREAD = math.radians(25)  # between shaft and barb


def head(before: Point, tip: Point) -> list[Point]:
    """The stroke of an arrow's head; before: a point of the shaft in front of the tip."""
    dx, dy = before[0] - tip[0], before[1] - tip[1]
    distance = math.hypot(dx, dy)
    if distance == 0:
        return []
    share = min(LENGTH, distance / 2) / distance
    barbs = []
    for angle in (SPREAD, -SPREAD):
        c, s = share * math.cos(angle), share * math.sin(angle)
        barbs.append((tip[0] + c * dx - s * dy, tip[1] + s * dx + c * dy))
    return [barbs[0], tip, barbs[1]]
