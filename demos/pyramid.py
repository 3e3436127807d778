"""The scene `pyramid` in a window: `python demos/pyramid.py`. What is in it: rigidarea/demos/pyramid.py."""

from rigidarea.draw.window import play

if __name__ == "__main__":
    raise SystemExit(play("pyramid"))
