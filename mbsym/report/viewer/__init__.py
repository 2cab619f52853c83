"""The page on which a system is seen in three dimensions: its motion, modes and equilibria beside its picture."""
