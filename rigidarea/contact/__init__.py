"""Kernels: pure numbers, compiled. They import neither pymunk nor pygame, validate nothing and allocate nothing.

In the order in which a substep runs through them: `pool` (outlines as arrays), `broad` (who is near), `predicates` and
`overlap` (the regions of two placed outlines, Alg. 1), `meet` (a pair's regions from substep to substep), `row` (what a
region asks for), `solve` and `conjugate` (all of them together), `relax` (positions). "theory n" in them is section n
of docs/theory.md; docs/contact.md has the walk.
"""
