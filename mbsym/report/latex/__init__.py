"""LaTeX reports: values for their templates, formulas broken into lines, labels and references."""
