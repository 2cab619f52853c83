"""Maps, slices, branches and numbers of equilibria: words, JSON, LaTeX, figures."""
