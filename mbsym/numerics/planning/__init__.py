"""Which model, method, step and arithmetic reach an accuracy for the least counted work."""
