"""Scenes on a plain pygame surface: stills, films, a window. Looks at a `gallery.Run`, changes nothing in it."""
