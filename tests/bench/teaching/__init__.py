"""How well attempts are found, timed, measured and corrected."""
