"""Digests: short names for content, equal for equal content."""

from __future__ import annotations

import hashlib

SHORT, USUAL, LONG = 8, 16, 32  # hexadecimal digits: for a table, for the name of a file, for a cache key


def digest(content: str | bytes, digits: int = USUAL) -> str:
    """The first hexadecimal digits of the SHA-256 of a text (UTF-8) or of bytes."""
    data = content.encode(errors="replace") if isinstance(content, str) else content
    return hashlib.sha256(data).hexdigest()[:digits]
