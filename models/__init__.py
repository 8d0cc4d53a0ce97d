"""What all sides of KineBox agree on. Imports numpy and msgspec, nothing of ours outside `models`, and does no I/O."""
