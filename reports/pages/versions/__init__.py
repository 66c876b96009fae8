"""Changes of engines from release to release."""
