"""The equations of motion linearised about the unperturbed motion.

    x' = x0' + J(t, x0) (x - x0),      x0(t) = (value + rate t, rate),      J = d rhs/dx

Their energies are those of the whole system, which this motion does not conserve.
"""

from __future__ import annotations

from functools import cached_property

from mbsym.algebra.base import Lowering
from mbsym.algebra.derivative import jacobian
from mbsym.algebra.program import Node
from mbsym.mechanics.motion import motion_values
from mbsym.model.system import velocity_name
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.specialise import Specialised, substituted


class LinearisedDynamics(Dynamics):
    """x' = x0' + J(t, x0(t)) (x - x0(t)) about the unperturbed motion x0 = (value + rate t, rate)."""

    @cached_property
    def right_hand_side(self) -> Code:
        whole = Dynamics(self.scenario, self.ring)
        plain, code = self._specialised, whole.right_hand_side
        at_rest, rates = self._motion(plain)
        rows = whole.jacobian
        image = _Placed(plain, {**at_rest, **rates})
        nodes = substituted(code.program, [*code.outputs, *rows.outputs], image)
        size = 2 * self.size
        images = [*at_rest.values(), *rates.values()]
        deviation = [plain.input(name) - image for name, image in zip(self.inputs[1:], images, strict=True)]
        outputs = []
        for i in range(size):
            total = nodes[i]
            for j in range(size):
                total = total + plain.product(nodes[size + i * size + j], deviation[j])
            outputs.append(total)
        return Code(plain, self.inputs, tuple(outputs))

    def _motion(self, program: Specialised) -> tuple[dict[str, Node], dict[str, Node]]:
        """The unperturbed positions and velocities as nodes in t."""
        lower = Lowering(program, program.bound)
        time_ = program.input("t")
        at_rest, rates = {}, {}
        for name, (value, rate) in motion_values(self.system).items():
            slope = lower(rate)
            at_rest[name] = lower(value) + program.product(slope, time_)
            rates[velocity_name(name)] = slope
        return at_rest, rates

    @cached_property
    def jacobian(self) -> Code:
        code = self.right_hand_side
        states = [code.program.input(name) for name in self.inputs[1:]]
        rows = jacobian(code.program, code.outputs, states)
        return Code(code.program, self.inputs, tuple(node for row in rows for node in row))


class _Placed(Specialised):
    """Writes into another program, with nodes of that program in place of some inputs."""

    def __init__(self, target: Specialised, images: dict[str, Node]) -> None:
        self.__dict__.update(target.__dict__)  # the same instructions and tables: nodes belong to the target
        self.bound = {**target.bound, **images}

    def __hash__(self) -> int:
        return id(self)
