"""The ink of a page in pieces, each measured once, and which of them may belong together."""
