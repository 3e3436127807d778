"""The scene `tower` in a window: `python demos/tower.py`. What is in it: rigidarea/demos/tower.py."""

from rigidarea.draw.window import play

if __name__ == "__main__":
    raise SystemExit(play("tower"))
