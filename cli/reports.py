"""From one description to its reports: derived, rendered, parsed again, delivered, told.

Whatever fails on the way stays where it happened: a formula in its problem, a problem in its file, a file in the batch.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym_cli.console import BAD_INPUT, FAILED, OK, blame, complain, read_description, shown, status
from mbsym_cli.files import deliver, obstacle

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.model.system import System
    from mbsym.numerics.ledger.entry import Ledger
    from mbsym.report.targets import Target
