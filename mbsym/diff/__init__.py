"""What changed between two results, exactly.

``diff(a, b)`` compares two ``results.json`` as they are read.  Formulas are parsed and compared in the exact ring:
equal ones that are printed otherwise are no change, of different ones the difference b - a is told.
"""

from mbsym.diff.documents import Change, Diff, Key, Kind, Renaming, diff

__all__ = ["Change", "Diff", "Key", "Kind", "Renaming", "diff"]
