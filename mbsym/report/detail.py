"""How much a report for people writes out: ``compact`` tells long formulas through named intermediates."""

from __future__ import annotations

COMPACT, FULL = "compact", "full"
DETAILS = (COMPACT, FULL)
