"""Energy, equations and integrals in speeds of their own, and their second routes."""
