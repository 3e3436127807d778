"""How kernels become machine code: ahead of time (`ahead`, `library`), or here by numba (`compiled`, `whole`, `cache`).

Kernels see none of it: they import `compile.jit`.
"""
