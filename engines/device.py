"""The device on which MJX, MuJoCo Warp and Newton run: a processor or a GPU."""

from __future__ import annotations

import os

from engines.contract import Unsupported

# The environment variable that names the device: `crosscheck run --device` sets it.
DEVICE = "CROSSCHECK_DEVICE"
DEVICES = ("cpu", "cuda")


def chosen_device() -> str:
    """The device by the environment variable, or the processor; raises Unsupported for an unknown one."""
    device = os.environ.get(DEVICE, DEVICES[0])
    if device not in DEVICES:
        raise Unsupported(f"the environment variable {DEVICE} is {device!r}; it must be 'cpu' or 'cuda'")
    return device
