"""Game scenes for rigidarea: every module has `build() -> rigidarea.gallery.Scene`.

`python -m rigidarea demo all` renders them all; `python -m demos.bowl` opens one in a window.
"""
