"""The site file: one TOML that says what this box has and how it shall work."""
