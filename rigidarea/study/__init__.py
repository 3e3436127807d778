"""Studies: what each choice costs and how wrong it is."""

from .cli import add_commands

__all__ = ["add_commands"]
