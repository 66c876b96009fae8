"""What can stand for a Roll in MuJoCo: contact as a user would build it, contact completed, or constraints.

`RollContact` is collision and friction, by public settings. `CompletedContact` adds the velocity term that contacts
lack. `RollRows` writes two exact rows in every stage. `RollEquality` develops a joint equality anew before every step.
"""

from engines.mujoco.joints.roll.contact import CompletedContact, RollContact
from engines.mujoco.joints.roll.rows import RollEquality, RollRows

RollBy = RollContact | CompletedContact | RollRows | RollEquality

__all__ = ["CompletedContact", "RollBy", "RollContact", "RollEquality", "RollRows"]
