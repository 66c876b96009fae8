"""The list of scenes, each with its default numbers."""

from __future__ import annotations

import difflib

from reference.checks import Name, validated
from reference.scene import Scene
from reference.scenes.andrews import Andrews
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar, SpinningFourBar
from reference.scenes.n_four_bar import FortyFourBars, NFourBar, TenFourBars
from reference.scenes.pendulum.link import BarPendulum, PointPendulum
from reference.scenes.pendulum.scenes import HundredLinks, LinkPendulum, TenLinks
from reference.scenes.person import OneFoot, SwayingOnOneFoot, TwoFeet
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import (
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
)
from reference.scenes.skates import ChaplyginSleigh, FreelyPinnedBody, PinnedBody, SleighBackwards
from reference.scenes.slider_crank import DrivenSliderCrank, FreeSliderCrank
from reference.scenes.wheels.vehicles import CarAndTrailer, Cart

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
    """The scene with this name. Raises ValueError with the nearest name for an unknown name."""
    by_name = {member.name: member for member in SCENES}
    if name in by_name:
        return by_name[name]
    near = difflib.get_close_matches(name, by_name, n=1, cutoff=0.0)
    raise ValueError(f"no scene is called {name!r}; did you mean {near[0]!r}? There are {', '.join(by_name)}")
