"""The scene `journal` in a window: `python demos/journal.py`. What is in it: rigidarea/demos/journal.py."""

from rigidarea.draw.window import play

if __name__ == "__main__":
    raise SystemExit(play("journal"))
