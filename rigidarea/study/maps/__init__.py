"""Maps of the atlas, one module each; a module is registered by being here and defining `atlas_map()`."""
