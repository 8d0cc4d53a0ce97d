"""Set-up code: exports the standards of the simulated library."""
