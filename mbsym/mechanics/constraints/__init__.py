"""Constraints over any scalar: their rows, the rank of these, and what follows for the equations of motion.

``seen.py``   how points and axes of one body move, seen from another
``rows.py``   f(q, t), the velocity form J q' + j, the acceleration form J q'' + (J' q' + j'), and J
"""
