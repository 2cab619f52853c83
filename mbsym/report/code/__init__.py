"""Generated programs: model.py, model.c and what their formulas need; readers that check what was written."""
