"""Game scenes: every module has `build() -> rigidarea.gallery.Scene`.

`python -m rigidarea demo all` renders them all; `python -m rigidarea demo bowl --window` opens one.
"""
