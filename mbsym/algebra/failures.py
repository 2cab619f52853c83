"""Failures as values: why a formula, a number or a result is not there, in words and as data.

A failure is raised where something cannot be had and caught where less will do.  ``code`` names its kind, ``limit``
the bound it met, if any; ``remedy`` says what to try next; ``severity`` tells an answer ("there is no closed form")
from a defect of ours.  Nobody has to read the sentence to know what happened.

=================  ==========================================================================
``NoClosedForm``   a formula outgrew a limit, or has no representation in this algebra
``TooLargeError``  the same of a determinant, resultant or discriminant of problem 6
``NotRational``    a value at a rational state is irrational: compare with enclosures instead
``SingularPoint``  a division by zero at the point where a formula is asked for
``NoValue``        a name has no number there
``Constrained``    something that leaves constraints out was asked of a system that has some
``NotInstalled``   a part of mbsym is needed that this installation lacks
``Defect``         an exception that nobody foresaw, contained
=================  ==========================================================================
"""

from __future__ import annotations

import logging
from enum import Enum

from mbsym.algebra.parts import missing
from mbsym.expressions.message import Message, worded

LOG = logging.getLogger("mbsym")


class Limit(Enum):
    """The bounds that a derivation can meet."""

    TERMS = "terms of a formula"
    WORK = "steps of arithmetic"
    MEMORY = "memory"
    DEGREE = "degree"
    DIGITS = "digits of a number"
    FUNCTIONS = "roots, reciprocals and functions"
    FACTORS = "terms that are factored"


class Severity(Enum):
    """``ANSWER``: that there is no such thing is the answer.  ``DEFECT``: the program is at fault."""

    ANSWER = "answer"
    DEFECT = "defect"


#: What helps where a formula is longer than its budget.
MORE_TERMS = "the straight-line program is available; raise --terms for more"


class Failure(Exception):
    """Something that was asked for is not there; the message, whose ``gaps`` are those of ``Message``, says why."""

    code = "failure"
    severity = Severity.ANSWER

    def __init__(self, message: str = "", *, limit: Limit | None = None, remedy: str = "", **gaps: object) -> None:
        super().__init__(Message(message, **gaps) if gaps else worded(message))
        self.limit = limit
        self.remedy = worded(remedy or (MORE_TERMS if limit is Limit.TERMS else ""))

    @property
    def reason(self) -> Message:
        """The message."""
        message: Message = self.args[0]
        return message


class NoClosedForm(Failure):
    """A formula outgrew the budget, or has no representation in this algebra; the message says which and why."""

    code = "no-closed-form"


class TooLargeError(Failure):
    """A determinant, resultant or discriminant has too many terms to be of use."""

    code = "too-large"


class NotRational(Failure):
    """A value at a rational state is irrational (a root, an exponential): compare with balls instead."""

    code = "irrational"


class SingularPoint(Failure, ZeroDivisionError):
    """A formula divides by zero at the point where it is asked for.

    ``except ZeroDivisionError`` catches these and the number library's own.
    """

    code = "singular"


class NotInstalled(Failure):
    """A part of mbsym was asked for that this installation lacks (``parts``); the message names it."""

    code = "not-installed"


class Defect(Failure):
    """An exception that nobody foresaw: the program is at fault, and only what it was about is lost.

    The exception itself is the ``__cause__``.  It is never lost: the logger ``mbsym`` gets it with its traceback, which
    Python shows on standard error unless somebody listens.
    """

    code = "internal-error"
    severity = Severity.DEFECT

    @classmethod
    def of(cls, error: Exception) -> Failure:
        """What to say of it, once it is logged; running out of memory, or lacking a part, is nobody's mistake."""
        if part := missing(error):
            return NotInstalled("[[part]] is not installed", part=part)
        if isinstance(error, MemoryError):
            defect = cls("out of memory", limit=Limit.MEMORY, remedy="lower --terms, or ask for fewer --problems")
        else:
            said = str(error).strip()
            kind = type(error).__name__ + (f": {said}" if said else "")
            defect = cls(Message("internal error: [[kind]]", kind=kind))
        defect.__cause__ = error
        LOG.error("%s", defect, exc_info=error)
        return defect


class Constrained(Failure):
    """Asked of a system with constraints, and would leave them out: there is no answer rather than a false one."""

    code = "constraints"


class GivenByMatrices(Failure):
    """Asked of a system that is given by its matrices, and about bodies: there is nothing that it could be about."""

    code = "given-by-matrices"


class NoLaw(Failure):
    """What needs numbers, or an equation that does not hold free functions of time, was asked where one has no law."""

    code = "no-law"


class NoValue(Failure, KeyError):
    """``args[0]`` is a name without a number."""

    code = "no-value"

    def __init__(self, name: str) -> None:
        Exception.__init__(self, name)
        self.limit = None
        self.remedy = worded("")

    def __str__(self) -> str:
        return str(self.reason)

    @property
    def reason(self) -> Message:
        """Which number there is not."""
        return Message("no number for [[name]]", name=self.args[0])


def message_of(error: Exception) -> Message:
    """What an exception says, ours or the number library's."""
    said = error.args[0] if error.args else ""
    return error.reason if isinstance(error, Failure) else said if isinstance(said, Message) else worded(str(error))


#: A formula cannot be had, or is not defined there, in our words or in the number library's.
NOT_THERE = (Failure, ZeroDivisionError)
