"""Kernels that only kernels call."""

from __future__ import annotations

from rigidarea.kernel.jit import kernel as inner

__all__ = ["inner"]
