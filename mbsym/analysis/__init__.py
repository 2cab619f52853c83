"""What is derived from a system, on demand: ``pipeline`` is the page to read, ``stages`` the machinery beneath it."""

from mbsym.analysis.pipeline import ALL_PROBLEMS, PROBLEMS, USUAL_PROBLEMS, Analysis, Problem
from mbsym.analysis.stages import Derived, NoResult, Stage, Unavailable
