"""A small pygame game to copy: catch the stars in the bucket (left and right arrows, Esc ends).

Bucket and stars are concave, as they are drawn: one outline each, nothing cut into convex pieces.
"""

import itertools
import math
import random

import pygame
import pymunk

import rigidarea as ra

WIDTH, HEIGHT = 640, 480  # pixels; y points down, as pygame has it
BUCKET = ra.Outline([(-60, -40), (-50, -40), (-42, 30), (42, 30), (50, -40), (60, -40), (50, 40), (-50, 40)])
STAR = ra.Outline([pymunk.Vec2d.from_polar((16, 7)[i % 2], i * math.pi / 5) for i in range(10)])


def corners(outline: ra.Outline, body: pymunk.Body) -> list[pymunk.Vec2d]:
    """The outline's corners on the screen."""
    return [body.local_to_world(tuple(point)) for point in outline.rings[0]]


def main() -> int:
    """Play; returns how many stars lie in the bucket at the end."""
    pygame.init()
    screen, clock = pygame.display.set_mode((WIDTH, HEIGHT)), pygame.time.Clock()
    space = pymunk.Space()
    space.gravity = 0, 600
    bucket = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    bucket.position = WIDTH / 2, HEIGHT - 60
    space.add(bucket, BUCKET.add_to(bucket, friction=0.9))
    stars: list[pymunk.Body] = []
    contact = ra.attach(space)  # without it, pymunk's own response to the convex hulls
    caught, keys = 0, pygame.key.get_pressed()
    for frame in itertools.count():
        if pygame.event.get(pygame.QUIT) or keys[pygame.K_ESCAPE]:
            return caught
        pygame.event.pump()
        keys = pygame.key.get_pressed()
        bucket.velocity = 300 * (keys[pygame.K_RIGHT] - keys[pygame.K_LEFT]), 0
        if frame % 60 == 0:
            star = STAR.body(density=0.01)
            star.position = random.uniform(80, WIDTH - 80), -20
            space.add(star, STAR.add_to(star, friction=0.5, elasticity=0.2))
            stars.append(star)
        contact.step(1 / 60)
        for star in [star for star in stars if star.position.y > HEIGHT + 50]:
            space.remove(star, *star.shapes)
            stars.remove(star)
        screen.fill("white")
        pygame.draw.polygon(screen, "steelblue", corners(BUCKET, bucket))
        for star in stars:
            pygame.draw.polygon(screen, "orange", corners(STAR, star))
        caught = sum(
            abs(star.position.x - bucket.position.x) < 50 for star in stars if star.position.y > HEIGHT - 95
        )
        pygame.display.set_caption(f"{caught} in the bucket")
        pygame.display.flip()
        clock.tick(60)


if __name__ == "__main__":
    main()
