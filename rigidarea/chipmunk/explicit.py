"""The paper's own step, for verification."""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from ..contact.islands import all_in_one_group, share_kicks
from ..contact.solve import finish, respond_explicitly
from ..contact.space_record import load_law, load_tables
from ..contact.tables import ROWS
from .frame_start import start_frame
from .substep import find_contacts
from .undo import keep_if_fragile


@kernel
def explicit_frame(s: Any, space: int, dt: float) -> bool:
    """The paper's step: F = k A where Chipmunk has moved the bodies to (symplectic Euler), joints after it."""
    if not start_frame(s, space, load_tables(s)):
        return False
    if not keep_if_fragile(s, space, dt):
        return False
    all_in_one_group(load_tables(s))
    share_kicks(load_tables(s), 1)
    if not find_contacts(s, space, dt, dt, False):
        return False
    tables = load_tables(s)
    s.contacts = tables.counters[ROWS]
    respond_explicitly(tables)
    finish(tables, load_law(s), s.frame, dt, True)
    return True
