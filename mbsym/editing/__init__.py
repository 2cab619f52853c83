"""Help while a description is written: complaints, completion, what a word means.  Pure functions of a text."""

from mbsym.editing.completion import Suggestion, suggestions
from mbsym.editing.hover import explanation
