"""Every sentence about oscillations has its Russian and Spanish, with the same gaps."""

from __future__ import annotations

import pytest

from mbsym.report.messages import messages
from mbsym.report.words import oscillation_words

SAID = {x for name, x in vars(oscillation_words).items() if name.isupper() and isinstance(x, str)}


@pytest.mark.parametrize("language", ["ru", "es"])
def test_no_sentence_is_missing(language):
    assert {("", text) for text in SAID} <= set(messages(language))
