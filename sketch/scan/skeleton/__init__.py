"""From ink to lines: the graph of its skeleton, in the middle of the ink, with the corners that the pen made."""
