"""Inertias that are taken as given although no body has them: said wherever a report lists the bodies."""

from __future__ import annotations

from mbsym.model.admissibility import body_violation, known_values
from mbsym.model.system import Body, System


def accepted_inertias(system: System) -> dict[str, str]:
    """For each body whose inertia is accepted, the inequality that it breaks, as far as the given numbers tell."""
    values = known_values(system)
    accepted = [body for body in system.bodies if _is_accepted(body)]
    return {body.name: body_violation(body, values) or "" for body in accepted}


def _is_accepted(body: Body) -> bool:
    return body.inertia is not None and body.inertia.accepted
