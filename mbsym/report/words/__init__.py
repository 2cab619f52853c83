"""Sentences about results, with gaps for formulas and names."""
