"""Rows to words: tables, numbers, templates."""
