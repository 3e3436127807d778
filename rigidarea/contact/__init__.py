"""Area contact of a pymunk space: record, overlap, row, solve, positions, report (docs/architecture.md)."""

from __future__ import annotations

from .attach import AreaContact, Settings, SimulationError, attach
from .report import REGIONS
from .space import attached

__all__ = ["REGIONS", "AreaContact", "Settings", "SimulationError", "attach", "attached"]
