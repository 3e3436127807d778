"""The scene `geneva` in a window: `python demos/geneva.py`. What is in it: rigidarea/demos/geneva.py."""

from rigidarea.draw.window import play

if __name__ == "__main__":
    raise SystemExit(play("geneva"))
