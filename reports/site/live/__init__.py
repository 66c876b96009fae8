"""Engines that run in the page: the models of our adapters as text and numbers, for every place of the sliders."""
