"""Sweeps: something of a system at very many parameter values, derived once and evaluated in machine code."""
