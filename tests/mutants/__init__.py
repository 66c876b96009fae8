"""Deliberate mistakes in reference, engines and reports, and what tells whether the tests notice them.

`python -m tests.mutants` (or `make mutants`) copies the tree, makes one mistake at a time in the copy, and runs the
tests that are named beside it. The lists are the `.toml` files beside this one, one table a mistake:

    [trailer-turns-the-wrong-way]           # the mistake's name, once in all lists
    file = "reference/scenes/wheels/trailers.py"
    mistake = "what is wrong, in one sentence"
    old = "text that stands exactly once in the file"
    new = "what stands there instead"
    tests = ["tests/test_wheels.py::test_bad_trains_are_refused"]   # the likeliest first
    survives = "why no test can or need notice it"                  # only for those that are allowed to get through

A mistake is caught when a named test fails, hangs or can't be imported. If all named ones pass, every test file that
imports the mistaken file's package is run before the mistake is said to have survived. A text that is not found exactly
once is listed as not applicable: the code has moved, and the list has to follow.

Why a list and no mutation tool (mutmut, cosmic-ray, poodle): they know operators and numbers, of which these packages
have about 14,700, and run a suite for each: at three seconds on two cores that is six hours. They can't make the
mistakes that people make in mechanics: a moment about another point, a velocity of the step before, a reaction on the
other body. Here every mistake is a sentence, and all of them are run in less than half an hour.
"""
