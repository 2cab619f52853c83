"""Parts that an installation may lack: the core imports none of them, loads none unasked, and works without them.

Whoever asks for one that is not there gets a sentence, no traceback (``failures.NotInstalled``).
"""

from __future__ import annotations

from importlib.util import find_spec

#: Problems 9 to 12, arrangements of curves and maps, robots, exports to other tools, the cluster.
PARTS = (
    "mbsym.algebra.arrangements",
    "mbsym.batch.cluster",
    "mbsym.batch.swept",
    "mbsym.maps",
    "mbsym.problems.invariant_sets",
    "mbsym.problems.normal_forms",
    "mbsym.problems.polynomial_integrals",
    "mbsym.problems.small_parameter",
    "mbsym.problems.symmetries",
    "mbsym.report.exports",
    "mbsym.report.maps",
    "mbsym.source.robots",
)


def missing(error: BaseException) -> str:
    """The part that an import did not find; "" where it failed for anything else."""
    name = (isinstance(error, ModuleNotFoundError) and error.name) or ""
    return next((part for part in PARTS if name == part or name.startswith(f"{part}.")), "")


def installed(part: str) -> bool:
    """Whether one of ``PARTS`` is there; nothing is loaded."""
    assert part in PARTS, part
    return find_spec(part) is not None
