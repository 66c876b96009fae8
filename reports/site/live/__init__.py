"""Models and controls of the engines that run in a page."""
