"""From what was read to what moves: bodies in metres, their pivots, and what a person meant but for the hand."""
