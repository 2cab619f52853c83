"""Exports: the equations as code that other programs read, one module a target; ``interface.py`` is what they share."""
