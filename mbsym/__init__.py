"""mbsym: exact symbolic mechanics of multibody systems from a text description.

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/simple-pendulum.yaml")
    >>> pendulum.energy.cyclic
    ()

``load`` reads a description (YAML or the editor's text) and returns an ``Analysis`` whose attributes ``kinematics``,
``energy``, ``equations``, ``equilibrium``, ``linearisation``, ``stability``, ``integrals``, ``claims`` and ``checks``
are derived when they are first asked for.  Matrices print as LaTeX in a notebook and convert with ``.to_sympy()``.

``run`` derives all of it, as the command does, and returns the reports and programs as texts.

``simulate`` integrates the equations of motion and returns times, coordinates, velocities and energy as arrays, with
how far the energy is known to be conserved and an estimate of the error.  ``tradeoff``, ``extremes`` and
``equilibria`` return what the commands of these names measure and find, as tables of arrays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mbsym.studies.described import DescriptionError as DescriptionError
    from mbsym.studies.described import load as load
    from mbsym.studies.described import loads as loads
    from mbsym.studies.floquet import floquet as floquet
    from mbsym.studies.inverse import inverse_dynamics as inverse_dynamics
    from mbsym.studies.lyapunov import lyapunov as lyapunov
    from mbsym.studies.orbit import orbit as orbit
    from mbsym.studies.regressor import regressor as regressor
    from mbsym.studies.run import run as run
    from mbsym.studies.simulate import simulate as simulate
    from mbsym.studies.simulate.functions import ensemble as ensemble
    from mbsym.studies.simulate.functions import gradient as gradient
    from mbsym.studies.simulate.functions import plan as plan
    from mbsym.studies.simulate.functions import sensitivities as sensitivities
    from mbsym.studies.tables import equilibria as equilibria
    from mbsym.studies.tables import extremes as extremes
    from mbsym.studies.tables import tradeoff as tradeoff
    from mbsym.studies.trim import trim as trim

__version__ = "0.1.0"

#: Where each public name is defined: nothing is imported before it is asked for.
_PLACES = {
    "described": ("DescriptionError", "load", "loads"),
    "floquet": ("floquet",),
    "inverse": ("inverse_dynamics",),
    "lyapunov": ("lyapunov",),
    "orbit": ("orbit",),
    "regressor": ("regressor",),
    "run": ("run",),
    "simulate": ("simulate",),
    "simulate.functions": ("ensemble", "gradient", "plan", "sensitivities"),
    "tables": ("equilibria", "extremes", "tradeoff"),
    "trim": ("trim",),
}
__all__ = [
    "DescriptionError",
    "ensemble",
    "equilibria",
    "extremes",
    "floquet",
    "gradient",
    "inverse_dynamics",
    "load",
    "loads",
    "lyapunov",
    "orbit",
    "plan",
    "regressor",
    "run",
    "sensitivities",
    "simulate",
    "tradeoff",
    "trim",
]


def __getattr__(name: str) -> Any:
    """A public name, from where it is defined."""
    from importlib import import_module

    for module, names in _PLACES.items():
        if name in names:
            attribute = globals()[name] = getattr(import_module(f"mbsym.studies.{module}"), name)
            return attribute
    raise AttributeError(f"module 'mbsym' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
