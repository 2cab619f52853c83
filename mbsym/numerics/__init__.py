"""Numbers: compiled kernels, integration, and what accuracy costs; everything starts from straight-line programs."""
