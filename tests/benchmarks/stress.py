"""`sketchsim bench stress`: hard scenes through this engine and through pymunk, side by side."""

from sim.bench.stress import main

__all__ = ["main"]
