"""Build hook of the wheel: with machine code, where it has been made before, else numba is one of its dependencies.

RIGIDAREA_LIBRARY names the folder that `python tools/library.py` has written (`make wheel` does both).
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class Hook(BuildHookInterface):
    """See the module."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """What goes into the wheel beside the sources."""
        folder = os.environ.get("RIGIDAREA_LIBRARY")
        if not folder or version == "editable":
            build_data["dependencies"] += self.metadata.core.optional_dependencies["compile"]
            return
        contents = json.loads((Path(folder) / "kernels.json").read_text())
        for name in (contents["library"], "kernels.json"):
            build_data["force_include"][str(Path(folder, name).resolve())] = f"rigidarea/compile/{name}"
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{contents['platform']}"
