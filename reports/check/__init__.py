"""The check of a user's model: facts, errors of its own settings, and settings that meet a tolerance."""
