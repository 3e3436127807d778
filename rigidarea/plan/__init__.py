"""Model no more than a scene needs: what a space asks for at a tolerance, before it is stepped.

print(ra.plan(space, tolerance=0.01))
"""

from .plan import Line, Plan, plan

__all__ = ["Line", "Plan", "plan"]
