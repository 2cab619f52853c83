"""``mbsym sweep``: its options, chunks that are kept, what is written."""
