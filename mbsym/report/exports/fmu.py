"""FMUs for model exchange, FMI 2.0 and 3.0: a zip of the C source, the functions of the interface, and a binary.

The declarations of FMI are written here again, so that nobody's headers are copied.  Where there is a C compiler, the
FMU holds a binary for this platform; else its sources alone.  All but the bytes of that binary are the same whenever
and wherever the FMU is made.
"""

from __future__ import annotations

import hashlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

from mbsym.algebra.failures import NoClosedForm
from mbsym.expressions.message import Message, worded
from mbsym.expressions.tree import Expression, names
from mbsym.formulas.names import free_name, injective
from mbsym.model.system import System
from mbsym.model.units import ENERGY, MULTIPLES, NONE, RATE, TIME, Dimension, times
from mbsym.numerics.scenario import exact
from mbsym.report.code import c_source
from mbsym.report.code.functions import coded, lawless
from mbsym.report.code.model_code import programs_of, solved
from mbsym.report.environment import rendered
from mbsym.report.exports.interface import Export, Language, export, told_in
from mbsym.report.unit_text import in_base_units

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


#: Names of this FMU's own C code.
_WORDS = """
    STATES PARAMETERS TIME FIRST_STATE FIRST_DERIVATIVE FIRST_PARAMETER ENERGY GENERALIZED_ENERGY VARIABLES
    EXPORT FMI_LOGGER TOKEN INSTANCE VALUES Values Instance Logger start state_names places parameter relate
    reset lacking get set directional told c v lead strayed led
"""

#: (operating system, processor) -> the folder of binaries in FMI 2.0 and 3.0, the ending of libraries.
_PLATFORMS = {
    ("linux", "x86_64"): ("linux64", "x86_64-linux", "so"),
    ("linux", "aarch64"): ("aarch64-linux", "aarch64-linux", "so"),
    ("darwin", "x86_64"): ("darwin64", "x86_64-darwin", "dylib"),
    ("darwin", "arm64"): ("aarch64-darwin", "aarch64-darwin", "dylib"),
}

#: Seconds that a compiler may take.
_PATIENCE = 300

# Functions of FMI 3.0 that this FMU has and that return an error: their arguments.
_CLOCKS = [("void *", "c"), ("const uint32_t *", "references"), ("size_t", "n")]
_REFUSED: dict[str, list[tuple[str, str]]] = {
    "GetBinary": [*_CLOCKS, ("size_t *", "sizes"), ("const uint8_t **", "values"), ("size_t", "n_values")],
    "SetBinary": [
        *_CLOCKS, ("const size_t *", "sizes"), ("const uint8_t *const *", "values"), ("size_t", "n_values"),
    ],
    "GetClock": [*_CLOCKS, ("bool *", "values")],
    "SetClock": [*_CLOCKS, ("const bool *", "values")],
    "GetIntervalDecimal": [*_CLOCKS, ("double *", "intervals"), ("int *", "qualifiers")],
    "GetIntervalFraction": [
        *_CLOCKS, ("uint64_t *", "counters"), ("uint64_t *", "resolutions"), ("int *", "qualifiers"),
    ],
    "GetShiftDecimal": [*_CLOCKS, ("double *", "shifts")],
    "GetShiftFraction": [*_CLOCKS, ("uint64_t *", "counters"), ("uint64_t *", "resolutions")],
    "SetIntervalDecimal": [*_CLOCKS, ("const double *", "intervals")],
    "SetIntervalFraction": [*_CLOCKS, ("const uint64_t *", "counters"), ("const uint64_t *", "resolutions")],
    "SetShiftDecimal": [*_CLOCKS, ("const double *", "shifts")],
    "SetShiftFraction": [*_CLOCKS, ("const uint64_t *", "counters"), ("const uint64_t *", "resolutions")],
    "GetNumberOfVariableDependencies": [("void *", "c"), ("uint32_t", "reference"), ("size_t *", "n")],
    "GetVariableDependencies": [
        ("void *", "c"), ("uint32_t", "dependent"), ("size_t *", "elements"), ("uint32_t *", "independents"),
        ("size_t *", "others"), ("int *", "kinds"), ("size_t", "n"),
    ],
    "SerializedFMUStateSize": [("void *", "c"), ("void *", "state"), ("size_t *", "size")],
    "SerializeFMUState": [("void *", "c"), ("void *", "state"), ("uint8_t *", "bytes"), ("size_t", "size")],
    "DeserializeFMUState": [("void *", "c"), ("const uint8_t *", "bytes"), ("size_t", "size"), ("void **", "state")],
    "EnterStepMode": [("void *", "c")],
    "GetOutputDerivatives": [
        *_CLOCKS, ("const int32_t *", "orders"), ("double *", "values"), ("size_t", "n_values"),
    ],
    "DoStep": [
        ("void *", "c"), ("double", "time"), ("double", "step"), ("bool", "final"), ("bool *", "event"),
        ("bool *", "terminate"), ("bool *", "early"), ("double *", "last"),
    ],
    "ActivateModelPartition": [("void *", "c"), ("uint32_t", "clock"), ("double", "time")],
}  # fmt: skip


@dataclass(frozen=True)
class Variable:
    """A variable of the model description; ``derivative`` is the reference of what it is the derivative of."""

    name: str
    reference: int
    words: str
    causality: str
    variability: str
    initial: str = ""
    start: str = ""
    derivative: int = 0
    unit: str = ""


def compiler() -> str | None:
    """The C compiler that makes binaries, where this platform has a place in an FMU."""
    known = (sys.platform, platform.machine()) in _PLATFORMS
    return next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None) if known else None


def remark() -> str:
    """What is to be said of an FMU that was made here, or ""."""
    if compiler():
        return ""
    return Message("no C compiler was found: the FMU holds its sources, and no binary for this platform")


def render(analysis: Analysis, problems: Sequence[int], version: int) -> bytes:
    """The FMU.  Raises NoClosedForm where there are no accelerations, or nothing that moves."""
    if not analysis.system.coordinates:
        raise NoClosedForm("nothing moves: an FMU needs a state")
    known = solved(analysis)
    if known.forward is None and not (analysis.system.constraints and programs_of(analysis)[0]):
        why = worded(str(known.no_forward or programs_of(analysis)[1]))
        raise NoClosedForm("there are no accelerations: [[why]]", why=why)
    files = sources(analysis, version)
    library = _library(analysis, files, version)
    return _zip(files | library)


def sources(analysis: Analysis, version: int) -> dict[str, bytes]:
    """The files of an FMU but for its binary, by their paths in it."""
    system = coded(analysis.system)
    code, header = c_source.render(analysis, (), whole=False), c_source.header(analysis, (), whole=False)
    prefix = c_source.prefix_of(system.name)
    reserved = c_source.RESERVED | c_source.declared(prefix) | frozenset(_WORDS.split())
    members = injective(system.parameter_names, c_source.proposed, taken=c_source.RESERVED | c_source.declared(prefix))
    model = export(analysis, (), Language(c_source.DIALECT, reserved, c_source.proposed), shared=())
    variables = tuple(_variables(analysis, model))
    references = {item.name: item.reference for item in variables}
    token = hashlib.sha256(f"{version}\n{header}\n{code}".encode()).hexdigest()[:32]
    values: dict[str, Any] = {
        "model": model,
        "prefix": prefix,
        "title": c_source.comment(system.name),
        "members": [(name, members[name]) for name in system.parameter_names],
        "starts": [(item.name, item.start.replace("NaN", "NAN")) for item in variables if item.initial == "exact"
                   and item.causality == "local"],
        "related": [
            {
                "member": members[item.name],
                "text": item.text,
                "reference": references[item.name],
                "needs": [(name, members[name], model.names[name]) for name in item.needs],
            }
            for item in model.ordered
            if item.needs
        ],
        # With inputs a directional derivative would be one by these, too.
        "slopes": solved(analysis).slopes is not None and not system.inputs and not lawless(system),
        "inputs": [(item.name, item.start.replace("NaN", "NAN")) for item in variables
                   if item.name in system.input_names],
        "moving": [members[item.name] for item in lawless(system)],
        "token": token,
        "tied": bool(system.constraints),
    }  # fmt: skip
    shared = rendered("exports/fmi.h.j2", {}, **values)
    written = rendered(f"exports/fmi{version}.c.j2", {}, shared=shared, refused=_refused(), **values)
    about = values | {
        "title": system.name,
        "description": " ".join(filter(None, [system.description, told_in(system)])),
    }
    measured, units = _measured(system, variables)
    about |= {"variables": measured, "units": units}
    files = {
        "modelDescription.xml": rendered(
            f"exports/modelDescription{version}.xml.j2", {"attribute": attribute}, **about
        ),
        "sources/model.c": code,
        "sources/model.h": header,
        f"sources/fmi{version}.c": written,
    }
    if version == 3:
        files["sources/buildDescription.xml"] = rendered("exports/buildDescription.xml.j2", {}, prefix=prefix)
    return {name: text.encode() for name, text in files.items()}


def _refused() -> list[tuple[str, list[tuple[str, str]]]]:
    return list(_REFUSED.items())


def _variables(analysis: Analysis, model: Export) -> Iterator[Variable]:
    """Time, x, x', parameters, energies, inputs: their places are their value references."""
    system = coded(analysis.system)
    names_ = [*system.coordinates, *system.velocities]
    taken = {*names_, *system.parameter_names, *system.input_names}
    yield Variable(free_name("time", taken), 0, "", "independent", "continuous")
    n, numbers = len(system.coordinates), _numbers(model)
    for place, (name, value) in enumerate(_starts(model, numbers)):
        words = "" if place < n else f"rate of {names_[place - n]}"
        yield Variable(name, 1 + place, words, "local", "continuous", "exact", value)
    for place, name in enumerate(names_):
        yield Variable(f"der({name})", 1 + 2 * n + place, "", "local", "continuous", "calculated", derivative=1 + place)
    first = 1 + 4 * n
    moving = {item.name for item in lawless(system)}
    for place, item in enumerate(model.parameters):
        if item.name in moving:
            yield Variable(item.name, first + place, item.meaning, "input", "continuous", start="0.0")
        elif item.needs:
            yield Variable(item.name, first + place, item.meaning, "calculatedParameter", "fixed", "calculated")
        else:
            start = _number(numbers.get(item.name))
            yield Variable(item.name, first + place, item.meaning, "parameter", "fixed", "exact", start)
    first += len(model.parameters)
    jacobi = "T2 - T0 - U: the energy where nothing moves as prescribed"
    for place, (name, words) in enumerate((("energy", "T - U"), ("generalized_energy", jacobi))):
        yield Variable(free_name(name, taken), first + place, words, "local", "continuous", "calculated")
    for place, signal in enumerate(system.inputs):
        start = _start(signal.held, numbers, "0.0")
        yield Variable(signal.name, first + 2 + place, signal.meaning, "input", "continuous", start=start)


def _measured(system: System, variables: Sequence[Variable]) -> tuple[list[Variable], list[Unit]]:
    """The variables with their units, and every unit once."""
    orders = {name: (name, 0) for name in (*system.coordinates, *system.parameter_names, *system.input_names)}
    orders |= {rate: (name, 1) for name, rate in zip(system.coordinates, system.velocities, strict=True)}
    orders |= {f"der({known})": (name, order + 1) for known, (name, order) in orders.items()}
    time, energy = time_and_energy(system)
    measured, units = [], dict[str, Unit]()
    energies = range(len(variables) - len(system.inputs) - 2, len(variables) - len(system.inputs))
    for place, item in enumerate(variables):
        if item.causality == "independent":
            unit = time
        elif place in energies:
            unit = energy
        else:
            unit = variable_unit(system, *orders[item.name])
        if unit is not None:
            units[unit.name] = unit
        measured.append(replace(item, unit=unit.name if unit is not None else ""))
    return measured, list(units.values())


def _numbers(model: Export) -> dict[str, Fraction]:
    """The parameters that have numbers, relations used."""
    expressions = {item.name: item.value for item in model.system.parameters if item.value is not None}
    expressions |= {item.name: item.value for item in model.system.relations}
    numbers: dict[str, Fraction] = {}
    for item in model.ordered:
        value = expressions.get(item.name)
        if item.text and value is not None and names(value) <= numbers.keys() | {"pi"}:
            numbers[item.name] = exact(value, numbers)
    return numbers


def _starts(model: Export, numbers: Mapping[str, Fraction]) -> Iterator[tuple[str, str]]:
    """(name, number) of q(0) and q'(0); NaN for what the description does not give."""
    values = {item.coordinate: item for item in model.system.begun}
    for name in model.system.coordinates:
        yield name, _start(values[name].position if name in values else None, numbers, "NaN")
    for name, rate in zip(model.system.coordinates, model.system.velocities, strict=True):
        yield rate, _start(values[name].velocity if name in values else None, numbers, "0.0")


def _start(value: Expression | None, numbers: Mapping[str, Fraction], otherwise: str) -> str:
    if value is None:
        return otherwise
    return _number(exact(value, numbers)) if names(value) <= numbers.keys() | {"pi"} else "NaN"


def _number(value: Fraction | None) -> str:
    if value is None:
        return "NaN"
    c_source.number(value)  # within the range of double
    return repr(float(value))


def attribute(words: str) -> str:
    """An attribute of XML in quotes, without what XML has no place for."""
    return quoteattr(re.sub("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "?", " ".join(words.split())))


def _library(analysis: Analysis, files: Mapping[str, bytes], version: int) -> dict[str, bytes]:
    """The binary by its path in the FMU; nothing where there is no compiler.  Raises RuntimeError if it refuses."""
    compiler_path = compiler()
    if compiler_path is None:
        return {}
    *folders, ending = _PLATFORMS[sys.platform, platform.machine()]
    name = f"{c_source.prefix_of(analysis.system.name)}.{ending}"
    options = ["-std=c99", "-O2", "-fPIC", "-fvisibility=hidden", "-shared"]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for path, content in files.items():
            if path.endswith((".c", ".h")):
                (folder / Path(path).name).write_bytes(content)
        command = [compiler_path, *options, "-o", name, f"fmi{version}.c", "model.c", "-lm"]
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, errors="replace", timeout=_PATIENCE, check=False
        )
        if done.returncode:
            raise RuntimeError(f"the C compiler refuses the sources of the FMU: {done.stderr[:2000]}")
        return {f"binaries/{folders[version - 2]}/{name}": (folder / name).read_bytes()}


def _zip(files: Mapping[str, bytes]) -> bytes:
    """Sorted, with the date at which zip archives begin: nothing in it tells when it was made."""
    whole = BytesIO()
    with zipfile.ZipFile(whole, "w") as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, files[name])
    return whole.getvalue()


# The units of the variables of an FMU, with what they are in SI.


@dataclass(frozen=True)
class Unit:
    """``name`` as variables have it; ``base`` the exponents of SI base units and of rad, ``factor`` its size in SI."""

    name: str
    base: tuple[tuple[str, int], ...]
    factor: float


def time_and_energy(system: System) -> tuple[Unit | None, Unit | None]:
    """The units of the time and of energies; None where they do not follow."""
    return _unit(system, TIME), _unit(system, ENERGY)


def variable_unit(system: System, name: str, order: int = 0) -> Unit | None:
    """The unit of a name or of its derivative of an order; None where it is not known, and for a pure number."""
    own = dict(system.units.inferred).get(name)
    return None if own is None else _unit(system, times(own, RATE, order), system.units.of(name) == "rad")


def _unit(system: System, dimension: Dimension, angle: bool = False) -> Unit | None:
    name = in_base_units(system, dimension, angle)
    if not name or any(exponent.denominator != 1 for _, exponent in dimension):
        return None
    base = [(unit, int(exponent)) for unit, exponent in dimension] + ([("rad", 1)] if angle else [])
    factor = 1.0
    if dimension != NONE:
        called = dict(system.units.base)
        for unit, exponent in dimension:
            sizes = {known: size for size, known in MULTIPLES.get(unit, {}).items()}
            factor *= sizes.get(called[unit], 1.0) ** int(exponent)
    return Unit(name, tuple(base), factor)
