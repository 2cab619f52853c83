"""``model.c`` and ``model.h``: the equations as portable C99, from the straight-line program.

Mass matrix, forcing, accelerations by factorisation (never an inverse), right-hand side, energy, generalised energy,
and the Jacobian of the right-hand side by differentiating the program.  What divides by pivots returns a status: not
zero where a result is not a finite number, as where the mass matrix is singular.

Every name that the linker or the preprocessor sees begins with the system's (``double_pendulum_mass_matrix``), so that
two models can be parts of one program.
"""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill, wrap
from typing import TYPE_CHECKING

from mbsym.algebra.failures import NoClosedForm
from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import Expression, names, text
from mbsym.formulas.names import injective
from mbsym.formulas.straight_line import Dialect, angle_name
from mbsym.model.quantities import marked, told_units
from mbsym.model.speeds import Quaternion
from mbsym.model.system import Parameter, System
from mbsym.numerics.scenario import exact
from mbsym.report.code.functions import Functions, c_definition, coded, courses, identifier
from mbsym.report.code.identifiers import number, prefix_of, spelled
from mbsym.report.code.model_code import FUNCTIONS, functions_of, programs_of, solved, undetermined
from mbsym.report.code.named_dynamics import bodies as bodies_of
from mbsym.report.code.named_dynamics import named_dynamics
from mbsym.report.environment import rendered

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.report.code.speed_code import SpeedCode

#: Words of C, C++ and their preprocessors, what <math.h> defines or declares, and what the file itself uses.
_WORDS = """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while asm typeof
    alignas alignof bool constexpr false nullptr static_assert thread_local true and and_eq bitand bitor catch class
    compl const_cast delete dynamic_cast explicit export friend mutable namespace new not not_eq operator or or_eq
    private protected public reinterpret_cast static_cast template this throw try typeid typename using virtual wchar_t
    xor xor_eq linux unix i386 near far complex imaginary I NULL EOF errno EDOM ERANGE
    NAN INFINITY HUGE HUGE_VAL HUGE_VALF HUGE_VALL MAXFLOAT DOMAIN SING OVERFLOW UNDERFLOW TLOSS PLOSS signgam
    M_E M_LOG2E M_LOG10E M_LN2 M_LN10 M_PI M_PI_2 M_PI_4 M_1_PI M_2_PI M_2_SQRTPI M_SQRT2 M_SQRT1_2
    FP_NAN FP_INFINITE FP_ZERO FP_SUBNORMAL FP_NORMAL FP_ILOGB0 FP_ILOGBNAN
    acos asin atan atan2 cos sin tan cosh sinh tanh acosh asinh atanh exp exp2 expm1 frexp ldexp log log2 log10 log1p
    logb ilogb modf pow sqrt cbrt hypot fabs abs ceil floor fmod round trunc rint remainder gamma lgamma tgamma erf erfc
    fma fmin fmax fdim nan nextafter copysign scalb scalbn drem significand isnan isinf isfinite isnormal signbit
    j0 j1 jn y0 y1 yn main
    math_errhandling MATH_ERRNO MATH_ERREXCEPT FP_FAST_FMA FP_FAST_FMAF FP_FAST_FMAL FLT_EVAL_METHOD
    SNAN SNANF SNANL FP_LLOGB0 FP_LLOGBNAN X_TLOSS
    t q qd qdd x xd p M f J i status slopes efforts pose
"""
RESERVED = frozenset(_WORDS.split())
#: What the file itself declares, with the prefix of the system in front; those in capitals are constants.
DECLARED = """
    parameters defaults coordinate_names parameter_names mass_matrix forcing energy generalized_energy accelerations
    right_hand_side jacobian input_names INPUTS H OK NOT_FINITE COORDINATES STATES PARAMETERS
    constraints constraint_velocity constraint_jacobian constraint_acceleration multipliers consistent reactions given
    CONSTRAINTS HOLONOMIC DEPENDENT NOT_CLOSED
    inverse_dynamics forward_dynamics coriolis gravity frame_names frame_pose frame_jacobian FRAMES
    speed_state speed_state_names speed_right_hand_side speed_restore SPEED_STATES
"""

#: The matrix of accelerations and multipliers stands on the stack.
MOST_UNKNOWNS, SPACE = 300, "more than a megabyte"


def call(function: str, argument: str) -> str:
    """A function of C's library, or what stands for it; a table's own."""
    if isinstance(function, Tabulated):
        return f"{identifier(function)}({argument})"
    if function == "sign":
        return f"(({argument}) > 0.0 ? 1.0 : ({argument}) < 0.0 ? -1.0 : 0.0)"
    return f"{'fabs' if function == 'abs' else function}({argument})"


DIALECT = Dialect(call=call, number=number, angle=angle_name, tables=True)


def render(analysis: Analysis, problems: Sequence[int], whole: bool = True) -> str:
    """The text of ``model.c``; without what robotics calls by name where it is not to be ``whole``."""
    return _rendered("model.c.j2", analysis, bodies=True, whole=whole)


def header(analysis: Analysis, problems: Sequence[int], whole: bool = True) -> str:
    """The text of ``model.h``."""
    return _rendered("model.h.j2", analysis, bodies=False, whole=whole)


def _rendered(template: str, analysis: Analysis, bodies: bool, whole: bool) -> str:
    system, (code, no_code) = coded(analysis.system), programs_of(analysis)
    n = len(system.coordinates)
    prefix = prefix_of(system.name)
    reserved = RESERVED | declared(prefix) | ({"u"} if system.inputs else set())
    reserved |= {"y", "yd"} if system.speeds else set()
    members = injective(system.parameter_names, proposed, taken=reserved)
    writer = Functions(system, DIALECT, reserved, proposed, "3.14159265358979323846")
    known = solved(analysis)
    tied = None
    if system.constraints and code:
        from mbsym.report.code.constrained_code import tied_code  # few systems have constraints

        tied = tied_code(analysis, writer)
        if n + len(tied.rows if tied else ()) > MOST_UNKNOWNS:
            raise NoClosedForm(
                "more than [[most]] accelerations and multipliers: C would need [[space]] of stack",
                most=MOST_UNKNOWNS,
                space=SPACE,
            )
    functions, entries = functions_of(analysis, writer, not tied) if bodies else (dict.fromkeys(FUNCTIONS), [])
    named = named_dynamics(analysis) if code and whole else None
    return rendered(
        template,
        {},
        system=system,
        prefix=prefix,
        capitals=prefix.upper(),
        title=comment(system.name),
        description=fill(comment(system.description), 110),
        n=n,
        members=[(name, members[name]) for name in system.parameter_names],
        defaults=[(item.name, _default(item.value)) for item in system.parameters],
        meanings={item.name: comment(meaning) for item in system.parameters if (meaning := _told(system, item))},
        units=wrap(comment(f"Units: {', '.join(told_units(system))}."), 110) if told_units(system) else [],
        relations=[(item.name, text(item.value)) for item in system.relations],
        prescribed=[(name, text(course)) for name, course in courses(system).items()],
        no_code=comment(no_code),
        no_solution="" if tied else comment(known.no_forward),
        no_slopes=comment(known.no_slopes or (known.no_forward if tied else "")),
        no_reactions=comment(known.no_reactions),
        undetermined=fill(comment(undetermined(analysis)), 110),
        has={
            "code": code is not None,
            "solved": known.forward is not None,
            "slopes": known.slopes is not None,
            "reactions": bool(known.reactions),
            "inverse": bool(named and named.inverse),
            "forward": bool(named and named.forward),
            "coriolis": bool(named and named.coriolis),
            "gravity": bool(named and named.gravity),
        },
        tied=tied,
        speeds=_speeds(analysis, writer) if known.forward else None,
        quaternions=any(isinstance(rotation, Quaternion) for body in system.bodies for rotation in body.orientation),
        functions=functions,
        named=bodies_of(named, writer, comment) if named and bodies else None,
        frames=[comment(frame.name) for frame in named.frames] if named else [],
        without=wrap(comment(named.told_without), 110, break_long_words=False) if named else [],
        upper=[(i, j) for i in range(n) for j in range(i, n)],
        entries=entries,
        lookups=[c_definition(table) for table in writer.tables],
    )


def _speeds(analysis: Analysis, writer: Functions) -> SpeedCode | None:
    """The code in speeds; None where the description declares none."""
    if not analysis.system.speeds:
        return None
    from mbsym.report.code.speed_code import speed_code

    return speed_code(analysis, writer)


def _told(system: System, item: Parameter) -> str:
    """What a parameter means, and its unit."""
    return marked(item.meaning, system.units.of(item.name)).strip()


def proposed(name: str) -> str:
    """A C identifier for a name; what C reserves gets an underscore at its end."""
    return spelled(name, RESERVED, lambda plain: plain.startswith("_"))


def declared(prefix: str) -> frozenset[str]:
    """The identifiers that the file declares under a prefix."""
    words = DECLARED.split()
    return frozenset(f"{prefix.upper() if word.isupper() else prefix}_{word}" for word in words)


def comment(words: str) -> str:
    """Text that may stand in a comment: nothing in it ends the comment or continues a line."""
    return " ".join(words.replace("\\", "/").replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").split())


def _default(value: Expression | None) -> str:
    """A number as C reads it in a constant initialiser, or NAN: nothing is made up."""
    if value is None or names(value) - {"pi"}:
        return "NAN"
    return number(exact(value, {}))
