"""Pendulums: one link exactly, chains of any number, problems 18.5.1 and 18.5.2, and the scenes."""

from reference.pendulum.chain import Chain
from reference.pendulum.double_pendulum import TwoPoints, accelerations, velocities
from reference.pendulum.link import BarPendulum, Pendulum, PointPendulum
from reference.pendulum.many_links import LongPendulum
from reference.pendulum.scenes import HundredLinks, LinkPendulum, TenLinks

__all__ = [
    "BarPendulum",
    "Chain",
    "HundredLinks",
    "LinkPendulum",
    "LongPendulum",
    "Pendulum",
    "PointPendulum",
    "TenLinks",
    "TwoPoints",
    "accelerations",
    "velocities",
]
