"""What a study has measured before: asked again, the same question costs nothing.

A question is known by the description's meaning with its numbers and by what was asked, under the source of mbsym, the
libraries that compute, and this machine: what differs in any of these is another question.  Answers stand beside the
machine code (``mbsym.numerics.kernels.stored``), by its rules of whom to trust; the folder may be deleted.
"""

from __future__ import annotations

import copyreg
import pickle
import platform
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from importlib import metadata
from typing import Any, TypeVar

from flint import acb, arb

from mbsym.batch.digests import derivation
from mbsym.numerics.kernels import stored

T = TypeVar("T")

#: Libraries whose versions decide what a run gives, or how long it takes.
LIBRARIES = ("numpy", "scipy", "llvmlite", "heyoka", "python-flint")


def remembered(
    question: Sequence[str], measure: Callable[[], T], sound: Callable[[T], bool], anew: bool
) -> tuple[T, bool]:
    """(the answer, whether it is an earlier one); only ``sound`` ones are kept, and ``anew`` none is looked for."""
    key = stored.key_of([derivation(), *_surroundings(), *question])
    pickled = None if anew else stored.load(key, stored.MEASURED)
    if pickled is not None:
        with suppress(Exception):  # written by ourselves, but by another Python
            answer: T = pickle.loads(pickled)
            return answer, True
    answer = measure()
    if sound(answer):
        with suppress(pickle.PicklingError, TypeError, ValueError):
            stored.keep(key, pickle.dumps(answer, pickle.HIGHEST_PROTOCOL), stored.MEASURED)
    return answer, False


def _of_balls(x: arb) -> tuple[Callable[..., arb], tuple[Any, ...]]:
    return _ball, tuple(tuple(map(int, part.man_exp())) for part in (x.mid(), x.rad()))


def _ball(middle: tuple[int, int], radius: tuple[int, int]) -> arb:
    """m 2^e about its middle.  Radii become the next number of 30 bits above what is given: given is a little less."""
    mantissa, exponent = radius
    more = 31 - mantissa.bit_length() if mantissa else 0
    return arb(arb(middle), arb(((mantissa << more) - bool(mantissa), exponent - more)))


copyreg.pickle(arb, _of_balls)
copyreg.pickle(acb, lambda z: (acb, (z.real, z.imag)))


def _surroundings() -> list[str]:
    machine = [sys.version, platform.node(), platform.machine(), platform.processor()]
    for name in LIBRARIES:
        try:
            machine.append(metadata.version(name))
        except metadata.PackageNotFoundError:
            machine.append("")
    return machine
