"""Area contact of a pymunk space: record, overlap, row, solve, positions, report (docs/architecture.md)."""

from __future__ import annotations

from .area_contact import AreaContact
from .asked import SimulationError
from .attach import Settings, attach, attached
from .contact_report import REGIONS

__all__ = ["REGIONS", "AreaContact", "Settings", "SimulationError", "attach", "attached"]
