"""The constructions of joints in MuJoCo, with one module for each kind."""
