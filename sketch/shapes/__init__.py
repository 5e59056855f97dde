"""What ink may be by itself: readings of groups of pieces, each with the length of its description."""
