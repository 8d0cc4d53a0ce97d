"""The bus of the box: Zenoh between processes, and an in-memory twin of the same behaviour for tests."""
