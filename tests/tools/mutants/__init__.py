"""Deliberate mistakes in mechanics (`physics.toml`), each with the test that notices the mistake."""
