"""From lines to strokes: the ways that the pen may have gone, and which of them make the most sense together."""
