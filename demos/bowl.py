"""The scene `bowl` in a window: `python demos/bowl.py`. What is in it: rigidarea/demos/bowl.py."""

from rigidarea.draw.window import play

if __name__ == "__main__":
    raise SystemExit(play("bowl"))
