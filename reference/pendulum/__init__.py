"""Pendulums: one link exactly, chains of any number, and their scenes."""

from reference.pendulum.chain import Chain
from reference.pendulum.link import BarPendulum, Pendulum, PointPendulum
from reference.pendulum.scenes import HundredLinks, LinkPendulum, TenLinks

__all__ = ["BarPendulum", "Chain", "HundredLinks", "LinkPendulum", "Pendulum", "PointPendulum", "TenLinks"]
