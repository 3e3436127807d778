"""The engines that the studies hold side by side; each module here with a `PEER` is one."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from .base import Peer, Run, Settings, drive, record


@cache
def peers() -> dict[str, Peer]:
    """Every peer by name, in alphabetical order of its module."""
    found: dict[str, Peer] = {}
    for info in sorted(pkgutil.iter_modules(__path__), key=lambda info: info.name):
        module = importlib.import_module(f"{__name__}.{info.name}")
        for peer in getattr(module, "PEERS", ()) or ([module.PEER] if hasattr(module, "PEER") else []):
            found[peer.name] = peer
    return found


def get_peer(name: str) -> Peer:
    """The peer called `name`; `ValueError` lists the known ones."""
    known = peers()
    if name not in known:
        raise ValueError(f"unknown peer {name!r}; expected one of {', '.join(known)}")
    return known[name]


__all__ = ["Peer", "Run", "Settings", "drive", "get_peer", "peers", "record"]
