"""What was left out of a model because its scene does not need it; one function a kind of saving."""
