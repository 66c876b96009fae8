"""What theory promises for rolling in each method, and where a method is known to fall short of it."""

from __future__ import annotations

ORDERS: dict[str, int] = {}
KNOWN: dict[tuple[str, str, str], str] = {}
