"""Literature behind the theorems of problem 6, of which a report lists those that it names, and the system's source."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mbsym.problems.stability.problem import Stability
from mbsym.problems.stability.words import (
    CHAPLYGIN,
    CHETAEV,
    CONVERSE,
    KELVIN_CHETAEV,
    LAGRANGE,
    LINEAR,
    LYAPUNOV,
    MALKIN,
    ROUTH,
)
from mbsym.report.conditions import cases


@dataclass(frozen=True)
class Reference:
    """``key`` is that of ``\\cite``; ``text`` is LaTeX."""

    key: str
    text: str


_LITERATURE = {
    "lagrange": r"J.-L. Lagrange, \textit{M\'echanique analitique}, Paris, 1788.",
    "dirichlet": (
        r"G. Lejeune Dirichlet, \"Uber die Stabilit\"at des Gleichgewichts, "
        r"\textit{J. reine angew. Math.} \textbf{32} (1846), 85--88."
    ),
    "routh": (
        r"E. J. Routh, \textit{A Treatise on the Stability of a Given State of Motion}, Macmillan, London, 1877."
    ),
    "thomson-tait": (
        r"W. Thomson (Lord Kelvin), P. G. Tait, \textit{Treatise on Natural Philosophy}, "
        r"Cambridge University Press, 1879."
    ),
    "chetaev": (
        r"N. G. Chetaev, \textit{Stability of Motion}, Gostekhizdat, Moscow, 1946; English translation (as Chetayev): "
        r"\textit{The Stability of Motion}, Pergamon Press, 1961."
    ),
    "lyapunov": (
        r"A. M. Lyapunov, \textit{The General Problem of the Stability of Motion}, Kharkov, 1892; "
        r"English translation by A. T. Fuller: Taylor \& Francis, London, 1992."
    ),
    "gantmacher": (
        r"F. R. Gantmacher, \textit{The Theory of Matrices}, vol. II, chapter XIV, Chelsea, New York, 1959."
    ),
    "malkin": (
        r"I. G. Malkin, \textit{Theory of Stability of Motion}, Gostekhizdat, Moscow, 1952; "
        r"English translation: US Atomic Energy Commission, AEC-tr-3352."
    ),
    "chaplygin": (
        r"S. A. Chaplygin, On a motion of a heavy body of revolution on a horizontal plane (1897); English "
        r"translation: \textit{Regul. Chaotic Dyn.} \textbf{7} (2002), 119--130."
    ),
}

#: The key of the system's source.
SOURCE = "source"

_OF_THEOREM = {
    LAGRANGE: ("lagrange", "dirichlet"),
    ROUTH: ("routh",),
    KELVIN_CHETAEV: ("thomson-tait", "chetaev"),
    LYAPUNOV: ("lyapunov",),
    MALKIN: ("lyapunov", "malkin"),
    CHAPLYGIN: ("routh", "chaplygin"),
    CHETAEV: ("chetaev",),
    CONVERSE: ("lyapunov", "chetaev"),
    LINEAR: ("gantmacher",),
}


def keys_of(theorem: str) -> tuple[str, ...]:
    """The keys of a theorem's literature; nothing for a name that is not listed."""
    return _OF_THEOREM.get(theorem, ())


def theorems_named(stability: Stability) -> Iterator[str]:
    """Every theorem that problem 6 names, in the order of the report, with repetitions."""
    for part in stability.subsystems:
        theory = part.theory
        for case in cases(part):
            yield from case.theorems if case.conditional else ()
        yield from theory.verdict.theorems
    yield from stability.verdict.theorems
    if stability.numerical is not None:
        yield from stability.numerical.theorems


def references(stability: Stability | None, source: str = "") -> tuple[Reference, ...]:
    """The literature that is needed, each once: the ``source`` of the system (in LaTeX), and that of the theorems."""
    named = [] if stability is None else list(theorems_named(stability))
    keys = dict.fromkeys(key for theorem in named for key in keys_of(theorem))
    own = (Reference(SOURCE, source),) if source else ()
    return own + tuple(Reference(key, text) for key, text in _LITERATURE.items() if key in keys)
