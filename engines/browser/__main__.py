"""Install the packages of npm that the engines of the browser need: `python -m engines.browser`."""

from engines.browser import install

install()
