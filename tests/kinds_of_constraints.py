"""One system with many coordinates, and every kind of constraint that may be put on it."""

from __future__ import annotations

BODIES = """
mbsym: 1
name: All kinds
parameters: {r: positive, m: positive, A: positive, L: positive, Om: real}
prescribed: {s: {rate: Om}}
bodies:
  - {name: base, attached to: 0, mass: m, rotation: {axes: [3], angles: [psi]}, connection point: [x, y, z],
     coordinates: [x, y, z, psi]}
  - {name: tilt, attached to: base, mass: 0, rotation: {axes: [1], angles: [theta]}}
  - {name: wheel, attached to: tilt, mass: m, rotation: {axes: [3], angles: [phi]}, inertia about: joint,
     inertia: [A, A, A]}
  - {name: arm, attached to: 0, mass: m, rotation: {axes: [2, 1, 3], angles: [a, b, c]}, connection point: [1, 0, 0],
     inertia about: joint, inertia: [A, A, A]}
  - {name: table, attached to: 0, mass: 0, rotation: {axes: [3], angles: [s]}, connection point: [0, sin(s), 0]}
constraints:
"""

KINDS = {
    "coincide": "{coincide: [{body: wheel, point: [r, 0, 0]}, {body: arm, point: [0, L, 0]}]}",
    "parallel": "{parallel: [{body: wheel, axis: [1, 0, 1]}, {body: arm, axis: [0, 0, 1]}]}",
    "distance": "{distance: {between: [{body: wheel, point: [r, 0, 0]}, {body: 0, point: [0, L, 0]}], "
    "length: L + sin(s)}}",
    "relation": "{relation: x - r*phi*sin(t) = y**2}",
    "rolling on a table that turns": "{rolling: {body: wheel, point: [0, -r*cos(phi), x*s], axes: tilt, on: table}}",
    "rolling on the ground": "{rolling: {body: wheel, point: [0, -r, 0], axes: tilt, on: ground}}",
    "rolling on a body": "{rolling: {body: wheel, point: [0, -r, t], on: arm}}",
    "velocity": "{velocity: x_dot*sin(psi) - y_dot*cos(psi) = Om*sin(s)*z + t*phi_dot}",
}
