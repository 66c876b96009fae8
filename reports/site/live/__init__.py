"""Engines that run in the page: the models of our adapters for every position of the sliders."""
