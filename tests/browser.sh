#!/usr/bin/env bash
# What tests/test_site_in_browser.py needs, on Debian: a browser, npm for packages of the site, emscripten for Munk2D.
# Run it as root, with the environment active; it takes about two minutes.
set -euo pipefail
cd "$(dirname "$0")/.."
apt-get update
apt-get install --yes --no-install-recommends chromium nodejs npm emscripten
python -m pip install --quiet --editable ".[test,browser]"
