"""The scene `platformer` in a window: `python demos/platformer.py`. What is in it: rigidarea/demos/platformer.py."""

from rigidarea.draw.window import play

if __name__ == "__main__":
    raise SystemExit(play("platformer"))
