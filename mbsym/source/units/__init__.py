"""Units, where a description has them: reading them, and finding slips by dimension."""

from mbsym.source.units.reading import read_units
from mbsym.source.units.system import checked_units
