"""The constructions of joints in pymunk, with one module for each kind."""
