"""Kernels: pure numbers, compiled. They import neither pymunk nor pygame, validate nothing and allocate nothing.

In the order in which a step runs through them: `pool` (outlines as arrays), `predicates` and `overlap` (the regions of
two placed outlines, Alg. 1), `force` (the force of a region, Alg. 2), `pair` (two shapes from step to step).
"""
