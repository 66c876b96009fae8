#!/usr/bin/env bash
# What the tests in a browser need, on Debian: a browser, and npm for packages of the site.
# Run it as root, with the environment active; it takes about two minutes.
set -euo pipefail
cd "$(dirname "$0")/../.."
wanted=()
command -v chromium > /dev/null || wanted+=(chromium)
# A Node.js that is no package of Debian's brings its own npm, beside which Debian's can't be installed.
command -v npm > /dev/null || wanted+=(nodejs npm)
if [ "${#wanted[@]}" -gt 0 ]; then
  apt-get update
  apt-get install --yes --no-install-recommends "${wanted[@]}"
fi
python -c "import playwright" 2> /dev/null || python -m pip install --quiet --editable ".[test,browser]"
