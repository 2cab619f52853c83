"""Hamilton's and Routh's forms of the equations, Poisson brackets, and their second routes."""
