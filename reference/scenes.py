"""The one list of scenes, each with its default numbers."""

from __future__ import annotations

import difflib

from reference.andrews import Andrews
from reference.four_bar.scenes import DrivenFourBar, FreeFourBar, SpinningFourBar
from reference.n_four_bar import FortyFourBars, NFourBar, TenFourBars
from reference.pendulum.link import BarPendulum, PointPendulum
from reference.pendulum.scenes import HundredLinks, LinkPendulum, TenLinks
from reference.person.one_foot import OneFoot
from reference.person.swaying import SwayingOnOneFoot
from reference.person.two_feet import TwoFeet
from reference.rolling.elliptic_gears import EllipticGears
from reference.rolling.scenes import (
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
)
from reference.scene import Scene
from reference.skate.pinned_body import FreelyPinnedBody, PinnedBody
from reference.skate.sleigh import ChaplyginSleigh, SleighBackwards
from reference.slider_crank.scenes import DrivenSliderCrank, FreeSliderCrank
from reference.validation import Name, validated
from reference.wheels.car_and_trailer import CarAndTrailer
from reference.wheels.cart import Cart

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
    Andrews(),
)


@validated
def scene(name: Name) -> Scene:
    """The scene of that name; raises ValueError that suggests the nearest name."""
    known = {each.name: each for each in SCENES}
    if name in known:
        return known[name]
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.0)
    raise ValueError(f"no scene is called {name!r}; did you mean {near[0]!r}? There are {', '.join(known)}")
