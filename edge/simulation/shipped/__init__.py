"""The lesson that comes with KineBox."""
