"""The device on which MJX, MuJoCo Warp and Newton run: a processor or a GPU."""

from __future__ import annotations

import os

from engines.contract import Unsupported

# Environment variable with the name of the device, which `crosscheck run --device` sets.
DEVICE = "CROSSCHECK_DEVICE"
DEVICES = ("cpu", "cuda")


def chosen_device() -> str:
    """The device that the variable names, by default the processor; raises Unsupported for an unknown device."""
    device = os.environ.get(DEVICE, DEVICES[0])
    if device not in DEVICES:
        raise Unsupported(f"the environment variable {DEVICE} is {device!r}; it must be 'cpu' or 'cuda'")
    return device
