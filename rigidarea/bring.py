"""What users bring: outlines from pictures and drawings, scenes as text. Nothing of it is ever executed.

    from rigidarea import bring
    logo = bring.outlines_from_svg("logo.svg", tolerance=0.1)
    scene = bring.load_scene("tower.toml")
    scene.attach()

Files come from anywhere: whatever they hold, they are read in bounded time and memory, or refused with a ValueError
that says what was expected (`limits`). The libraries that read them: `pip install 'rigidarea[bring]'`.
"""

from .io.geojson import outlines_from_geojson
from .io.limits import LIMITS, Limits
from .io.raster import outlines_from_image, outlines_from_mask
from .io.save import save_scene, scene_as_text
from .io.scene_file import Scene, load_scene, scene_from_text
from .io.svg import Element, elements_from_svg, outlines_from_svg

__all__ = [
    "LIMITS",
    "Element",
    "Limits",
    "Scene",
    "elements_from_svg",
    "load_scene",
    "outlines_from_geojson",
    "outlines_from_image",
    "outlines_from_mask",
    "outlines_from_svg",
    "save_scene",
    "scene_as_text",
    "scene_from_text",
]
