"""Munk2D, the engine inside pymunk, compiled to WebAssembly from pymunk's own source package."""
