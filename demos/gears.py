"""The scene `gears` in a window: `python demos/gears.py`. What is in it: rigidarea/demos/gears.py."""

from rigidarea.draw.window import play

if __name__ == "__main__":
    raise SystemExit(play("gears"))
