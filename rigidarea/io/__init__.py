"""Drawings, pictures and scene files, read and written: what `rigidarea.bring` offers."""
