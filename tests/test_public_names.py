"""What a user imports is offered by the package of its mechanism: every scene, and every name that it lists."""

import importlib
import inspect
import pkgutil
import subprocess
import sys

import pytest

import reference
from reference.scene import Scene
from reference.scenes.catalogue import SCENES

PACKAGES = [module.name for module in pkgutil.iter_modules(reference.__path__, "reference.") if module.ispkg]


def scenes_below(package):
    """The scene classes that the modules of a package define, but for those that a user can't make."""
    found = pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
    modules = [importlib.import_module(each.name) for each in found]
    classes = {value for module in modules for value in vars(module).values() if inspect.isclass(value)}
    return {
        cls.__name__
        for cls in classes
        if issubclass(cls, Scene) and cls.__module__.startswith(package.__name__) and hasattr(cls, "name")
    }


@pytest.mark.parametrize("name", PACKAGES)
def test_a_package_has_what_it_lists_and_lists_its_scenes(name):
    package = importlib.import_module(name)
    if name == "reference.numerics":  # for the suite's own use
        assert not hasattr(package, "__all__")
        return
    assert list(package.__all__) == sorted(package.__all__)
    assert all(hasattr(package, each) for each in package.__all__)
    assert scenes_below(package) <= set(package.__all__)


def test_every_scene_of_the_list_is_imported_from_its_package():
    for scene in SCENES:
        package = importlib.import_module(".".join(type(scene).__module__.split(".")[:2]))
        assert getattr(package, type(scene).__name__) is type(scene)


def test_the_two_problems_and_parking_are_where_a_first_user_looks():
    from reference.chapter.errata.linkages import accelerations, velocities
    from reference.chapter.parking import Move, park

    assert velocities(1.0, (0.0, 0.0), (2.0, 1.0)).b == pytest.approx([3.0, 0.0])
    assert accelerations(1.0, (0.0, 0.0), (2.0, 0.0), (0.0, 0.0)).a == pytest.approx([0.0, 4.0])
    assert park((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)) == (Move(0.0, 1.0), Move(0.0))


def test_an_unknown_name_of_the_rolling_package_is_an_attribute_error():
    rolling = importlib.import_module("reference.rolling")
    with pytest.raises(AttributeError, match="no attribute 'RollingSquare'"):
        _ = rolling.RollingSquare


def test_a_joint_is_imported_without_any_scene():
    code = "import sys, reference.joints, reference.mechanism; print([m for m in sys.modules if 'scene' in m])"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"
