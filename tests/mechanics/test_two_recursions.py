"""Why there are two recursions: the one for kernels, at q'' = 0, takes fewer operations than the general one there."""

from __future__ import annotations

import pytest
from conftest import SHIPPED

import mbsym
from mbsym.algebra.program import Program
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.programs import programs
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import acceleration_name


@pytest.mark.parametrize("name", ["satellite", "spatial-arm", "double-pendulum", "heavy-top"])
def test_the_leaner_recursion_pays(name: str) -> None:
    analysis = mbsym.load(SHIPPED / f"{name}.yaml")
    system, lean = analysis.system, programs(analysis.system, analysis.ring)
    program = Program()
    still = {acceleration_name(q): program.zero for q in system.coordinates}
    scene = Scene(system, program, program_environment(system, program) | still, analysis.ring)
    general = program.operations([-x for x in residuals(scene).values()])
    assert lean.program.operations(lean.forcing) < 0.9 * general
