#!/usr/bin/env bash
# The types of the site's scripts, which stand in their comments, checked by TypeScript; npm fetches it by version.
set -euo pipefail
cd "$(dirname "$0")/../../reports/site/assets"
npm exec --yes --silent --package=typescript@5.9.3 -- \
  tsc --noEmit --allowJs --checkJs --strict --noImplicitReturns --noUnusedLocals --noUnusedParameters \
  --target es2022 --module es2022 --moduleResolution bundler --lib es2023,dom,dom.iterable ./*.js
