"""The scene `rubber` in a window: `python demos/rubber.py`. What is in it: rigidarea/demos/rubber.py."""

from rigidarea.draw.window import play

if __name__ == "__main__":
    raise SystemExit(play("rubber"))
