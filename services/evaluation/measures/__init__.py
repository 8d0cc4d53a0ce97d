"""Numbers that an attempt has: signals reduced over its phases, and functions of their own; each with its sigma."""
