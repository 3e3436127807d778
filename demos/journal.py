"""The scene `journal` in a window: `python demos/journal.py`. What is in it: rigidarea/demos/journal.py."""

from rigidarea.gallery import play

if __name__ == "__main__":
    raise SystemExit(play("journal"))
