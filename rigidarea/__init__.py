"""Rigid-body contact by overlap area for pymunk."""
