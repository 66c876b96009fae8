#!/usr/bin/env bash
# Mistakes made by rule in one module, and which of them the tests let through; cosmic-ray works in a clone of HEAD.
# tests/tools/generated.sh MODULE TESTS, for example reference/plane.py tests/reference/test_mechanism.py
set -euo pipefail
[ $# -ge 2 ] || { echo "usage: $0 MODULE TESTS ..." >&2; exit 2; }
tree=$(cd "$(dirname "$0")/../.." && pwd)
python=${PYTHON:-$tree/.venv/bin/python}
work=$(mktemp -d "${TMPDIR:-/tmp}/generated.XXXXXX")
trap 'rm -rf "$work"' EXIT
git clone --quiet "$tree" "$work/clone" && cd "$work/clone"
cat > "$work/config.toml" << END
[cosmic-ray]
module-path = "$1"
timeout = 120.0
excluded-modules = []
test-command = "$python -m pytest -x -q -p no:cacheprovider ${*:2}"
[cosmic-ray.distributor]
name = "local"
END
"$python" -m cosmic_ray.cli init "$work/config.toml" "$work/session.sqlite"
"$python" -m cosmic_ray.cli exec "$work/config.toml" "$work/session.sqlite"
"$(dirname "$python")/cr-report" "$work/session.sqlite" | grep -A 3 -B 3 -E "SURVIVED|^total|^complete|^surviving"
