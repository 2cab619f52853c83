"""On how many examples a property is tried: ``settings`` in place of Hypothesis's own.

``max_examples`` is what the profile ``thorough`` tries, which ``make test-all`` asks for.  The other one, ``quick``,
tries a quarter of them, and always the same: a test that fails is one that was broken.
"""

from __future__ import annotations

from math import ceil
from typing import Any

import hypothesis

#: What Hypothesis tries where nothing is said: examples of ``thorough``, and a hundred per cent of the others.
THOROUGH = 100

hypothesis.settings.register_profile("quick", max_examples=25, derandomize=True, deadline=None)
hypothesis.settings.register_profile("thorough", max_examples=THOROUGH, deadline=None)
hypothesis.settings.load_profile("quick")


def settings(max_examples: int = THOROUGH, **others: Any) -> hypothesis.settings:
    """Hypothesis's, with the profile's share of the examples."""
    share = ceil(max_examples * hypothesis.settings().max_examples / THOROUGH)
    return hypothesis.settings(max_examples=share, **others)
