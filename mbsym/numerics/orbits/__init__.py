"""Derivatives of motions by states and parameters, and what stands on them: orbits, multipliers, exponents."""
