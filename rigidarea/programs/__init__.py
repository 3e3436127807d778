"""Other people's pymunk programs, run as they are with area contact attached to every space that they make.

`host` runs a program (headless, or as it would run by itself), `screen` and `null_pyglet` take the place of a window,
`run` is the command `rigidarea run`.
"""
