"""One-way platforms: the game's own pre_solve says no, and area contact obeys."""

import math

import pymunk

from ..gallery import Headline, Scene, new_space

PLAYER, PLATFORM = 1, 2
"""Collision types."""
G = 9.81
STEP, LEVELS = 2.2, 5
"""Height between platforms (m), their number."""
WIDTH, THICK = 5.0, 0.25
"""Of a platform (m)."""
JUMP = math.sqrt(2 * G * (STEP + 0.5))
"""Speed of a jump (m/s)."""
EVERY = 1.3
"""Seconds from jump to jump."""


def build() -> Scene:
    """A player who jumps up through five platforms, then drops through them again; crates, a belt, a lift."""
    space = new_space(0.005, G)

    def solid(
        body: pymunk.Body, width: float, height: float, friction: float, radius: float = 0.0
    ) -> pymunk.Poly:
        shape = pymunk.Poly.create_box(body, (width - 2 * radius, height - 2 * radius), radius)
        shape.friction = friction
        space.add(shape)
        return shape

    ground = pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0)
    ground.friction = 0.8
    space.add(ground)
    for x in (-9.15, 9.15):
        wall = pymunk.Body(body_type=pymunk.Body.STATIC)
        wall.position = x, 3.5
        space.add(wall)
        solid(wall, 0.3, 7.0, 0.2)

    tops = [STEP * (i + 1) for i in range(LEVELS)]
    colors = {}
    for i, top in enumerate(tops):
        body = pymunk.Body(body_type=pymunk.Body.STATIC)
        body.position = (0.8 if i % 2 else -0.8), top - THICK / 2
        space.add(body)
        solid(body, WIDTH, THICK, 0.8).collision_type = PLATFORM
        colors[body] = 5

    belt = pymunk.Body(body_type=pymunk.Body.STATIC)
    belt.position = 6.0, 0.2
    space.add(belt)
    solid(belt, 4.0, 0.4, 1.0).surface_velocity = (0.8, 0)
    colors[belt] = 6
    lift = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    lift.position = -6.0, 2.0
    space.add(lift)
    solid(lift, 2.6, 0.3, 0.8)
    colors[lift] = 6

    crates = []
    for x, y in (
        (-6.5, 2.6),
        (-5.5, 2.6),
        (-6.0, 3.4),
        (5.0, 0.8),
        (5.9, 0.8),
        (2.6, 4.8),
        (-2.6, 2.6),
        (2.7, 9.2),
    ):
        crate = pymunk.Body(0.64, 0.64 * 0.8**2 / 6)
        crate.position = x, y
        space.add(crate)
        solid(crate, 0.8, 0.8, 0.8)
        crates.append(crate)
        colors[crate] = 0

    player = pymunk.Body(1.0, math.inf)
    player.position = 0.0, 0.5
    space.add(player)
    hero = solid(player, 0.6, 1.0, 0.8, radius=0.15)
    hero.collision_type = PLAYER
    colors[player] = 2

    passing: set[pymunk.Shape] = set()
    plan = {"down": False, "next": 0.4}
    climbed: set[int] = set()

    def begin(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        platform = arbiter.shapes[1]
        below = player.position.y - 0.5 < platform.bb.top - 0.05
        if below or plan["down"]:
            passing.add(platform)

    def one_way(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        if plan["down"] or arbiter.shapes[1] in passing:
            arbiter.process_collision = False

    def separate(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        passing.discard(arbiter.shapes[1])

    space.on_collision(PLAYER, PLATFORM, begin=begin, pre_solve=one_way, separate=separate)

    def drive(t: float) -> None:
        """The lift goes up and down; the player jumps by the clock, and drops when all is climbed."""
        lift.velocity = 0, 1.2 * math.sin(1.5 * t)
        feet = player.position.y - 0.5
        if t > plan["next"]:
            plan["next"] = t + EVERY
            if len(climbed) == LEVELS:
                plan["down"] = True
            else:
                player.velocity = (0.3 if len(climbed) % 2 else -0.3), JUMP
        if plan["down"] and feet < 0.5:
            plan["down"] = False
            plan["next"] = math.inf
        if not plan["down"] and abs(player.velocity.y) < 0.05:
            climbed.update(i for i, top in enumerate(tops) if abs(feet - top) < 0.02)

    return Scene(
        name="platformer",
        title="One-way platforms",
        shows="The player rises through platforms that carry crates: the game's own pre_solve decides.",
        space=space,
        view=(-10.2, -0.6, 10.2, 12.9),
        headline=Headline("platforms_climbed", lambda: float(len(climbed)), float(LEVELS)),
        chipmunk="as it is",
        frames=540,
        still=0.2222,
        drive=drive,
        energy="driven",
        force=20.0,
        colors=colors,
    )
