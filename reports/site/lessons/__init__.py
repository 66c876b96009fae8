"""The lessons: which motions each shows and in which order; their words stand beside, one Markdown file a lesson."""

from reports.site.lessons.linkages import CENTRODES, FOUR_BAR, PENDULUM, SLIDER_CRANK
from reports.site.lessons.rolling import GEARS, ROLLING
from reports.site.lessons.skates import SKATE, WHEELS

LESSONS = (FOUR_BAR, SLIDER_CRANK, SKATE, WHEELS, ROLLING, PENDULUM, GEARS, CENTRODES)
