"""Problem 11: what terms of higher order decide where the first approximation does not."""
