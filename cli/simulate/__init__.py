"""``mbsym simulate``: its options, read and held against each other; the run, what is written, what is said of it."""
