"""Every sentence about oscillations has its Russian and Spanish, with the same gaps."""

from __future__ import annotations

import re

import pytest

from mbsym.report import oscillation_words, oscillations_es, oscillations_ru

SAID = {x for name, x in vars(oscillation_words).items() if name.isupper() and isinstance(x, str)}


@pytest.mark.parametrize("catalogue", [oscillations_ru.SENTENCES, oscillations_es.SENTENCES])
def test_no_sentence_and_no_gap_is_missing(catalogue):
    assert set(catalogue) == SAID
    for english, other in catalogue.items():
        assert sorted(set(re.findall(r"\[\[\w+\]\]", other))) == sorted(set(re.findall(r"\[\[\w+\]\]", english)))
