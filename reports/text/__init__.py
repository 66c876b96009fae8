"""Rows to words: tables, the overview, templates to pages."""
