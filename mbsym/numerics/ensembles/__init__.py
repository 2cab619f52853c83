"""Many motions side by side: one compiled kernel, one lane of it a motion."""
