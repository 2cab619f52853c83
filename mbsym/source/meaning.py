"""What a description says, as a number: equal for the two spellings, for any order of keys, and for any comments."""

from __future__ import annotations

import hashlib

from mbsym.model.system import System
from mbsym.source.yaml_writer import to_yaml


def meaning(system: System) -> str:
    """SHA-256, in hexadecimal digits, of the description as ``mbsym convert`` writes it in YAML."""
    return hashlib.sha256(to_yaml(system).encode()).hexdigest()
