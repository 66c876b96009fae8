#!/usr/bin/env bash
# pymunk 7.3.1: a copy of a space does not keep the length of a PinJoint whose `distance` was set. The copy uses the distance
# between the bodies. One would expect that Space.copy() copies every property.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check pymunk==7.3.1
"$folder/environment/bin/python" - <<'PYTHON'
import pymunk

space = pymunk.Space()
body = pymunk.Body(1, 1)
body.position = (1, 0)
rope = pymunk.PinJoint(space.static_body, body)
space.add(body, rope)
rope.distance = 1.5
(copied,) = space.copy().constraints
print(f"pymunk {pymunk.version}: distance {rope.distance} in the space, {copied.distance} in its copy")
assert (rope.distance, copied.distance) == (1.5, 1.0), "the behaviour has changed"
PYTHON
