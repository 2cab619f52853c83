"""Back ends: from a straight-line program to something that computes numbers."""
