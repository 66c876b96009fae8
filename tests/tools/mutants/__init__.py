"""Deliberate mistakes in mechanics (`physics.toml`), and the test that notices each of them."""
