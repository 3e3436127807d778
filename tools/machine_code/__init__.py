"""What makes a wheel's machine code ahead of time, in a checkout: `ahead`, `callers`, `rehearsal`, `runtime.c`.

What loads it in an installed package is `rigidarea.compile.library`.
"""
