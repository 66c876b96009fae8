"""A user's own model, checked: what it is, how wrong its own settings are, and which settings meet a tolerance."""
