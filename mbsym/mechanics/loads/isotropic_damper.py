"""A damper against all relative motion of two points."""

from __future__ import annotations

from mbsym.algebra.base import S
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.between import Pair, closing, noted
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model.loads import IsotropicDamper


def _isotropic_damper_action(load: IsotropicDamper, scene: Scene[S]) -> Action[S]:
    """coefficient (V_second - V_first) on the first point."""
    pair = Pair(load.first, load.second, scene)
    coefficient = scene.lower(load.coefficient)
    return pair.action(closing(pair, scene) * coefficient)


KIND = Kind(_isotropic_damper_action, notes=noted)
