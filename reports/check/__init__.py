"""The check of a user's model: facts, errors of the user's settings, and settings that meet a tolerance."""
