"""Rows as text: numbers, tables, CSV files, templates."""
