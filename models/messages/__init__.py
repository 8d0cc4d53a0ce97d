"""The messages on the bus, their wire format and their topics."""
