"""The HTML page: values for its templates, formulas as MathML."""
