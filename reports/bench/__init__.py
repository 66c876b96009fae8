"""Benchmarks: `times` has CPU times of our own parts, and `peers` compares the judge with other engines."""
