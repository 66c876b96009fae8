"""The page that compares engines: pymunk, MuJoCo and the extras."""
