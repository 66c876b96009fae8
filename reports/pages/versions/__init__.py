"""What changed in engines from release to release."""
