#!/usr/bin/env bash
# The steps of workflow.yml and action.yml on this machine: try.sh FOLDER [PATCH...], patches of pymunk's sources.
set -euo pipefail
suite=$(cd "$(dirname "$0")/../.." && pwd)
patches=()
for patch in "${@:2}"; do patches+=("$(realpath "$patch")"); done
mkdir -p "$1" && cd "$1"
release=7.3.1

${PYTHON:-python3.11} -m venv environment
. environment/bin/activate
python -m pip download --quiet --no-deps --no-binary pymunk "pymunk==$release"
tar xzf "pymunk-$release.tar.gz"
find "pymunk-$release/Munk2D" -name '*.[ch]' -exec sed -i 's/\r$//' {} +
for patch in "${patches[@]}"; do patch -d "pymunk-$release" -p1 < "$patch"; done

python -m pip wheel --quiet --no-deps --wheel-dir dist "./pymunk-$release"
python -m pip install --quiet "$suite"
export GITHUB_STEP_SUMMARY=summary.md
set +e
crosscheck compare "pymunk==$release" dist/*.whl --cost 1.5 --markdown > comparison.md
status=$?
cat comparison.md >> "$GITHUB_STEP_SUMMARY"
cat comparison.md
exit $status
