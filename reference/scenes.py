"""The one list of scenes, each with its default numbers."""

from __future__ import annotations

import difflib

from reference.cart import Cart
from reference.elliptic_gears import EllipticGears
from reference.four_bar_scenes import DrivenFourBar, FreeFourBar, SpinningFourBar
from reference.link_chain_scenes import HundredLinks, LinkPendulum, TenLinks
from reference.n_four_bar import FortyFourBars, NFourBar, TenFourBars
from reference.pendulum import BarPendulum, PointPendulum
from reference.person import OneFoot
from reference.person_swaying import SwayingOnOneFoot
from reference.person_two_feet import TwoFeet
from reference.pinned_body import FreelyPinnedBody, PinnedBody
from reference.rolling_scenes import (
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
)
from reference.scene import Scene
from reference.sleigh import ChaplyginSleigh, SleighBackwards
from reference.slider_crank_scenes import DrivenSliderCrank, FreeSliderCrank
from reference.wheels import CarAndTrailer

SCENES: tuple[Scene, ...] = (
    DrivenFourBar(),
    FreeFourBar(),
    SpinningFourBar(),
    ChaplyginSleigh(),
    SleighBackwards(),
    PinnedBody(),
    FreelyPinnedBody(),
    CarAndTrailer(),
    Cart(),
    RollingEllipse(),
    RollingDisc(),
    RollingCam(),
    RollingDownhill(),
    RollingInRing(),
    RollingOnCircle(),
    EllipticGears(),
    BarPendulum(),
    LinkPendulum(),
    TenLinks(),
    HundredLinks(),
    PointPendulum(),
    DrivenSliderCrank(),
    FreeSliderCrank(),
    NFourBar(),
    TenFourBars(),
    FortyFourBars(),
    SwayingOnOneFoot(),
    OneFoot(),
    TwoFeet(),
)


def scene(name: str) -> Scene:
    """The scene of that name; raises ValueError that suggests the nearest name."""
    known = {each.name: each for each in SCENES}
    if name in known:
        return known[name]
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.0)
    raise ValueError(f"no scene is called {name!r}; did you mean {near[0]!r}? There are {', '.join(known)}")
