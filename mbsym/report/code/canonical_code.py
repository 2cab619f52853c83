"""What ``model.py`` holds of Hamilton's and Routh's forms: states, H, rates, from the closed forms through programs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.program import Program
from mbsym.formulas.formula import Formula
from mbsym.formulas.names import injective
from mbsym.mechanics.programs import momenta
from mbsym.mechanics.variables import program_environment
from mbsym.report.canonical import Forms, forms_of
from mbsym.report.code.functions import Function, Functions
from mbsym.report.code.programs import programs_of

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.problems.canonical import Hamilton, Routh


@dataclass(frozen=True)
class HamiltonCode:
    """``unpacked`` is what the code calls the entries of y = (s, p); ``state`` are p of a state (q, q'), or all of y
    where s are not q."""

    positions: tuple[str, ...]
    plain: bool
    names: tuple[str, ...]
    unpacked: tuple[str, ...]
    state: Function
    hamiltonian: Function
    rates: Function


@dataclass(frozen=True)
class RouthCode:
    """``unpacked`` is what the code calls s and s', ``constants`` what it calls beta; ``kept`` are places of s in q,
    ``rows`` those of beta among ``momenta``; the results of ``function`` are the upper half of M_R, then f_R."""

    coordinates: tuple[str, ...]
    ignored: tuple[str, ...]
    names: tuple[str, ...]
    unpacked: tuple[str, ...]
    constants: tuple[str, ...]
    kept: tuple[int, ...]
    momenta: Function
    upper: tuple[tuple[int, int], ...]
    function: Function
    potential: Function
    ignored_rates: Function


@dataclass(frozen=True)
class FormsCode:
    """The code of the forms that were asked for and have a result; ``lacking`` says in sentences what is not there."""

    hamilton: HamiltonCode | None
    routh: RouthCode | None
    lacking: tuple[str, ...]


def canonical_code(analysis: Analysis, problems: Sequence[int], writer: Functions) -> FormsCode:
    """The code; none where the system has inputs, which functions of (t, q, p) would not know."""
    forms = forms_of(analysis, (*problems, 3) if 3 in analysis.problems else problems)
    code, missing = programs_of(analysis)
    lacking = [f"There is no code of {_TITLES[name]}: {why.reason}" for name, why in forms.failures if name in _TITLES]
    if analysis.system.inputs or (code is None and (forms.routh or (forms.hamilton and forms.hamilton.plain))):
        reason = "inputs are not taken into account there" if analysis.system.inputs else missing
        there = [title for name, title in _TITLES.items() if getattr(forms, name) is not None]
        return FormsCode(None, None, (*lacking, *(f"There is no code of {title}: {reason}" for title in there)))
    names = {name for form in (forms.hamilton, forms.routh) if form is not None for name in form.momenta}
    taken = {*writer.reserved, *writer.names.values()}
    writer.names |= injective(sorted(names), lambda name: name + "_" if name in taken else name, taken)
    return _Code(analysis, writer).forms(forms, tuple(lacking))


_TITLES = {"routh": "Routh's form", "hamilton": "Hamilton's form"}


class _Code:
    def __init__(self, analysis: Analysis, writer: Functions) -> None:
        self.system, self.writer = analysis.system, writer
        self.analysis = analysis

    def forms(self, found: Forms, lacking: tuple[str, ...]) -> FormsCode:
        return FormsCode(
            None if found.hamilton is None else self._hamilton(found.hamilton),
            None if found.routh is None else self._routh(found.routh),
            lacking,
        )

    def _hamilton(self, hamilton: Hamilton) -> HamiltonCode:
        return HamiltonCode(
            positions=hamilton.positions,
            plain=hamilton.plain,
            names=hamilton.momenta,
            unpacked=self._called((*hamilton.positions, *hamilton.momenta)),
            state=self._momenta(self.system.coordinates) if hamilton.plain else self._state(hamilton),
            hamiltonian=self._function([hamilton.hamiltonian], hamilton.momenta),
            rates=self._function([*hamilton.velocities, *hamilton.rates], hamilton.momenta),
        )

    def _routh(self, routh: Routh) -> RouthCode:
        m, names = len(routh.coordinates), self.system.coordinates
        upper = tuple((i, j) for i in range(m) for j in range(i, m))
        velocities = [self.system.velocities[names.index(name)] for name in routh.coordinates]
        entries = [routh.mass_matrix[i, j] for i, j in upper]
        return RouthCode(
            coordinates=routh.coordinates,
            ignored=routh.ignored,
            names=routh.momenta,
            unpacked=self._called((*routh.coordinates, *velocities)),
            constants=self._called(routh.momenta),
            kept=tuple(names.index(name) for name in routh.coordinates),
            momenta=self._momenta(routh.ignored),
            upper=upper,
            function=self._function([*entries, *routh.forcing], routh.momenta),
            potential=self._function([routh.reduced_potential], routh.momenta),
            ignored_rates=self._function(routh.ignored_rates, routh.momenta),
        )

    def _called(self, names: Iterable[str]) -> tuple[str, ...]:
        return tuple(self.writer.names[name] for name in names)

    def _momenta(self, coordinates: Sequence[str]) -> Function:
        """dL/dq' of some coordinates at (q, q'): the recursion's own."""
        code = self.analysis.programs
        known = dict(zip(self.system.coordinates, momenta(code, self.system), strict=True))
        return self.writer.function(code.program, [known[name] for name in coordinates])

    def _state(self, hamilton: Hamilton) -> Function:
        """(s, p) at (q, q')."""
        form, program = self.analysis.form, Program()
        nodes = form.state_in_coordinates(program)
        own = dict(zip((x.name for x in (*form.positions, *form.speeds)), nodes, strict=True))
        carry = Carrier(hamilton.hamiltonian.ring, program, program_environment(self.system, program) | own)
        momenta = [carry(x.polynomial) for x in hamilton.momenta_in_velocities]
        return self.writer.function(program, [*(own[name] for name in hamilton.positions), *momenta])

    def _function(self, formulas: Sequence[Formula], names: Sequence[str]) -> Function:
        """Formulas in which momenta are names."""
        program = Program()
        environment = program_environment(self.system, program)
        environment |= {name: program.input(name) for name in (*names, *self.system.variables)}
        carry = Carrier(formulas[0].ring, program, environment)
        return self.writer.function(program, [carry(x.polynomial) for x in formulas])
