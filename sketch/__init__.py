"""Ink to scenes: strokes or pictures of sketches, read as bodies, anchors, pivots and gravity.

``recognize(load_sketch("cart.json")).scene`` is a `sim.Scene`.
"""

from __future__ import annotations

from sketch.formats import load_sketch
from sketch.ink import Sketch, Stroke
from sketch.recognize import Reading, Recognition, Recognizer, recognize

__all__ = ["Reading", "Recognition", "Recognizer", "Sketch", "Stroke", "load_sketch", "recognize"]
