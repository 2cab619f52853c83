"""A reduction as an author asks for it: ``r1=1,h3=1 by integrals; q1,h2 by p1,h1; p1=p2+eps*lam; O(eps**3)``.

Between semicolons stand steps: variables that are eliminated ``by`` integrals, with what they are at first, or by the
equations of other variables; a change of variables, and letters for what stands in it; last, if anything is to be
sorted by powers of a parameter, from which one on it is left out.
"""

from __future__ import annotations

import re

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Complaints
from mbsym.model.reducing import Asked, Reducing
from mbsym.source.scaling import assignments

_REMAINDER = re.compile(r"\s*O\(\s*(\w+)\s*(?:(?:\*\*|\^)\s*(\d+)\s*)?\)\s*")


def read_reduction(text: str, complaints: Complaints) -> Reducing | None:
    """The steps; None after a complaint.  Names are looked up where the equations are known."""
    steps: list[Asked] = []
    small, known = "", None
    start = 0
    for piece in text.split(";"):
        left, by, right = piece.partition(" by ")
        remainder = _REMAINDER.fullmatch(piece)
        if remainder is not None:
            small, known = remainder[1], int(remainder[2] or 1)
        elif piece.strip():
            items = list(assignments(left, complaints, start))
            of = list(assignments(right, complaints, start + len(left) + len(by)))
            for one in [x for x in items if x.bare and not by] + [x for x in of if not x.bare]:
                message = Message("[[text]] is no step of a reduction", text=ascii_safe(one.name) or "nothing")
                hint = "for example 'r=1 by integrals', 'q by p', 'p=p1+eps*a', and 'O(eps**3)' as the last one"
                complaints.error("bad-step", message, one.span, hint)
            expressions = {item.name: item.value for item in items if not item.bare}
            steps.append(Asked(tuple(item.name for item in items), expressions, tuple(one.name for one in of)))
        start += len(piece) + 1
    return None if complaints.errors else Reducing(tuple(steps), small, known)
