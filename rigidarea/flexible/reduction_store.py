"""Results on disk, found by the content they were computed from."""

from __future__ import annotations

import hashlib
import os
import tempfile
import warnings
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

VERSION = 8  # of the content: raise it when a stored computation changes


def arrays(
    directory: Path | str | None,
    settings: object,
    inputs: Sequence[NDArray],
    names: Sequence[str],
    build: Callable[[], dict[str, NDArray]],
) -> dict[str, NDArray]:
    """``build()``'s arrays by name, from ``directory`` if they are there (None: no cache).

    The key is a hash of ``settings`` (by repr) and ``inputs`` (by content). A file that cannot be read, or lacks
    one of ``names``, is built again, with a warning; a new one appears under its name only when complete.
    """
    if directory is None:
        return build()
    digest = hashlib.sha256(repr((VERSION, settings)).encode())
    for a in inputs:
        digest.update(repr(a.shape).encode() + np.ascontiguousarray(a).tobytes())
    path = Path(directory) / f"{digest.hexdigest()[:32]}.npz"
    if path.exists():
        try:
            with np.load(path, allow_pickle=False) as stored:
                return {name: stored[name] for name in names}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
            warnings.warn(f"cache file {path} cannot be read ({error}); built again", stacklevel=3)
    built = build()
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, part = tempfile.mkstemp(dir=path.parent, suffix=".part")
    with os.fdopen(handle, "wb") as out:
        np.savez(out, **built)  # type: ignore[arg-type]
    os.replace(part, path)
    return built
