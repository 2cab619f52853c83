"""Maps: exact regions of parameters in which problem 6 gives one verdict, with the curves and points between them."""
