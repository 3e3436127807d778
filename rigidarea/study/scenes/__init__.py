"""Scenes with exact answers, one module each; a module is registered by being here and defining `scene()`."""
