"""Deliberate mistakes in reference, engines and reports, and what tells whether the tests notice them.

Mistakes come from two places. `physics.toml` has those that people make in mechanics, written by hand: a moment about
another point, a velocity of half a step before, a reaction on the other body. The others are made by rule wherever the
syntax tree has a place for one, in every file (generated.py); a seed draws some.

    python -m tests.tools.mutants run [words]      each mistake, until a test fails; `make mutants`
    python -m tests.tools.mutants matrix [words]   each mistake with *all* its likely tests: who noticed
    python -m tests.tools.mutants read             what the matrix says of the tests
    python -m tests.tools.mutants list [words]     the mistakes alone
    python -m tests.tools.mutants trace            anew, which tests run which code, by which likely tests are chosen

Words choose by beginnings of files, and by names. Everything is kept below `crosscheck-results/mutants`. Each mistake
is made in a copy of the tree, and asked about in a process of its own with a limit of time.
"""
