"""Rows and poses to pictures; nothing here knows a page."""
