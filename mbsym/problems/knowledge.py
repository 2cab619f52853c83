"""What a description tells about signs: declared signs, assumptions, and the signs of the user's own symbols.

Conditions are stated in the user's notation where they can be, so its symbols get signs too, by proof from their
definitions; what cannot be proved stays "real" until an assumption says more.  A symbol or an assumption whose formula
is singular or beyond all budgets tells nothing: less is known then, and nothing that is known is wrong.
"""

from __future__ import annotations

from collections.abc import Iterable

from flint import arb

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure, SingularPoint
from mbsym.algebra.remembered import remembered
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import MOST_TERMS, Signs
from mbsym.expressions.tree import names
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations

_FLIPPED = {"<": ">", "<=": ">="}


def signs(scene: Scene) -> Signs:
    """Signs of all generators of the ring, and the assumptions as polynomials compared with zero."""
    ring = scene.ring
    dependent = relations(scene)  # first, for the roots that relations bring with them
    declared = {parameter.name: parameter.sign for parameter in scene.system.parameters} | {"pi": "positive"}
    words = [declared.get(g.name, "real") if g.kind == "parameter" else "real" for g in ring.generators]
    for index, g in enumerate(ring.generators):
        if g.kind == "root":
            words[index] = "positive" if g.argument.is_constant() else "nonnegative"
        elif g.kind == "function" and g.name == "exp":
            words[index] = "positive"
    numbers = _numbers(ring)
    for index, value in numbers.items():
        if value > 0 or value < 0:
            words[index] = "positive" if value > 0 else "negative"
    known = _with_reciprocals(scene, Signs(ring.context, tuple(words), numbers=numbers))
    words = list(known.words)
    definitions = _definitions(scene)
    for item in scene.system.notation:
        if item.name not in definitions:
            continue
        try:
            definition = ring.substitute(definitions[item.name], dependent)
        except Failure:
            continue
        words = list(_with_reciprocals(scene, Signs(ring.context, tuple(words), numbers=numbers)).words)
        word = Signs(ring.context, tuple(words), numbers=numbers).sign(definition)
        if word not in ("unknown", "zero"):
            words[ring.index("parameter", item.name)] = word
    plain = Signs(ring.context, tuple(words), numbers=numbers)
    assumed = Signs(ring.context, tuple(words), _assumptions(scene, plain), numbers=numbers)
    assumed = assumed.assuming(_radicands(ring, dependent.values(), assumed))
    return _with_reciprocals(scene, assumed.assuming(_bounds(scene, assumed)))


def _radicands(ring: Ring, values: Iterable[Polynomial], assumed: Signs) -> list[tuple[Polynomial, str]]:
    """x >= 0 of every sqrt(x) by which parameters are given: they are real numbers.

    As a polynomial that is top * bottom, x = top/bottom; > 0, and the root with it, where top is known not to vanish.
    """
    facts = []
    for k in occurring(values):
        g = ring.generators[k]
        if g.kind != "root" or g.argument is None or g.argument.is_constant():
            continue
        try:
            product, below = ring.fraction(g.argument)
            strict = assumed.never_zero(product)
            for bottom, exponent in below:
                product = ring.times(product, bottom) if exponent % 2 else product
        except Failure:
            continue
        if len(product) <= MOST_TERMS and assumed.sign(product) not in ("negative", "nonpositive", "zero"):
            facts.append((product, ">" if strict else ">="))
            facts += [(ring.context.gen(k), ">")] * strict
    return facts


def _numbers(ring: Ring) -> dict[int, arb]:
    """Enclosures of the generators that are numbers, such as pi, sqrt(2), sin(pi/7), sin(3/10) and 1/sin(3/10)."""
    values = {k: ring.constant_value(ring.context.gen(k)) for k in range(len(ring.generators))}
    return {k: value for k, value in values.items() if value is not None}


def _bounds(scene: Scene, assumed: Signs) -> list[tuple[Polynomial, str]]:
    """-1 <= cos <= 1 for every constant angle, strictly where its sine is known not to vanish; sin likewise."""
    ring = scene.ring
    facts = []
    for name in (name for name in ring.angles if ring.has("parameter", name)):
        pair = (ring.generator("sine", name), ring.generator("cosine", name))
        for bounded, other in (pair, pair[::-1]):
            strict = assumed.never_zero(other)
            facts += [(ring.one + sign * bounded, ">" if strict else ">=") for sign in (1, -1)]
    return facts


def _with_reciprocals(scene: Scene, known: Signs) -> Signs:
    """1/p has the sign of p, and sqrt(p) > 0 where p > 0."""
    words = list(known.words)
    for index, g in enumerate(scene.ring.generators):
        if g.kind == "root" and words[index] == "nonnegative" and known.sign(g.argument) == "positive":
            words[index] = "positive"
        if g.kind == "reciprocal" and words[index] == "real":
            word = known.sign(g.argument)
            words[index] = {"nonnegative": "positive", "nonpositive": "negative"}.get(word, word)
            if words[index] in ("unknown", "zero"):
                words[index] = "nonzero"
    return Signs(known.context, tuple(words), known.assumptions, known.normal, known.numbers)


def _assumptions(scene: Scene, plain: Signs) -> tuple[tuple[Polynomial, str], ...]:
    """left - right > 0 and the like, denominators of known sign cleared."""
    assumptions = []
    for item in scene.system.assumptions:
        try:
            left, right = scene.lower(item.left), scene.lower(item.right)
            if item.relation in _FLIPPED:
                left, right = right, left
            numerator, denominators = scene.ring.fraction(left - right)
        except Failure:
            continue
        relation = _FLIPPED.get(item.relation, item.relation)
        for factor, exponent in denominators:
            word = plain.sign(factor)
            if word == "negative" and exponent % 2:
                numerator = -numerator
            elif word != "positive" and exponent % 2:
                numerator = scene.ring.times(numerator, factor)
        assumptions.append((numerator, relation))
    return tuple(assumptions)


def definition_in_parameters(scene: Scene, name: str) -> Polynomial:
    """A symbol of the user's notation, earlier symbols replaced by what they stand for.

    Raises SingularPoint where that divides by zero or has no closed form: the symbol has no value then.
    """
    definitions = _definitions(scene)
    if name not in definitions:
        raise SingularPoint("the symbol [[name]] has no closed form", name=name)
    return definitions[name]


@remembered  # it is asked for symbol by symbol
def _definitions(scene: Scene) -> dict[str, Polynomial]:
    """The user's symbols in declared parameters alone, those left out that have no such form."""
    ring = scene.ring
    images: dict[int, Polynomial] = {}
    definitions: dict[str, Polynomial] = {}
    missing: set[str] = set()
    for item in scene.system.notation:
        try:
            if names(item.value) & missing:
                raise SingularPoint("an earlier symbol is missing")
            definitions[item.name] = ring.substitute(scene.lower(item.value), images)
            images[ring.index("parameter", item.name)] = definitions[item.name]
        except Failure:
            missing.add(item.name)
    return definitions
