"""The scene `cradle` in a window: `python demos/cradle.py`. What is in it: rigidarea/demos/cradle.py."""

from rigidarea.draw.window import play

if __name__ == "__main__":
    raise SystemExit(play("cradle"))
