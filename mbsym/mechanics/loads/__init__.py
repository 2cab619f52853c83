"""Loads, one kind a file; ``mbsym.mechanics.loads.kinds`` is the table of them."""
