"""The numbers of the contact law that nobody is asked for: all dimensionless, each with its reason.

What the user chooses (stiffness or penetration, law, sweeps, substeps) is not here.
"""

#: Substeps of a frame, unless asked otherwise. Two: what the first one met the second one already answers, and the
#: sweeps, not the substeps, are what piles need.
SUBSTEPS = 2
#: Most substeps that a tolerance may ask for.
MOST_SUBSTEPS = 1024
#: (w h)^2 up to which a step h follows a contact of frequency w explicitly: 28 steps an oscillation. Symplectic Euler
#: is stable up to 4; its restitution is then within 0.002. Only of a stiffness that was given: one that we choose says
#: how deep a body lies, and its oscillation is nobody's.
FOLLOWED = 0.05
#: A contact pressed too far opens again in so many substeps (1/e time): the row's S. It does so without giving speed
#: (`relax`), so that little depends on it.
RELEASE_STEPS = 8.0
#: An overlap that somebody has put there is taken apart no faster than this many smallest extents of the smaller body
#: a second (1/time): nobody expects to see it go.
PUT_SPEED = 1.0
#: And one into which a body has brought itself that moves as it is told faster, since it may go on: a drum, a press, a
#: platform that is moved by its place. (Box2D v3: 3 m/s, its bodies of a metre.)
DRIVEN_SPEED = 4.0
#: And what somebody has put there with no more than so many times the load that the pair carries, where no stiffness is
#: given: k A of two discs in one place is thousands of times their weight, which walls and joints would have to bear.
PLACED_LOADS = 30.0
#: Damping ratio, for e = 0, of a contact at rest that the step follows.
REST_DAMPING = 1.0
#: Tangential over normal stiffness. Cundall & Strack (1979) leave it free; 2/7 makes a sphere's two periods equal.
TANGENT_STIFFNESS = 2.0 / 7.0
#: First touch slower than what the load gives in so many substeps (or natural times, where they are longer) is rest.
#: (A hair more than two: what has fallen from rest for two is as fast as that exactly, and rounding would decide.)
REST_KICKS = 2.0001
#: Deeper (at first touch, or than before) than so many substeps' motion: put there, not come there. No impact then.
MOST_ARRIVED = 2.0
#: And by this fraction of the smaller one's smallest extent: less may be what a solve has left, and carries a load;
#: but not where the step follows the contact, whose spring would throw the two.
PUT = 0.1
PUT_FOLLOWED = 0.01
#: Restitution below this is taken as this: the exact law's damping grows as 1/e.
LEAST_RESTITUTION = 0.01
#: Largest fraction of the smaller one's least extent that a pair may move in a step between two looks at its overlap.
LOOK = 0.5
#: And so many looks at the most: a card of 2 mm is met at up to 1,200 m/s, two substeps a frame.
MOST_LOOKS = 1e4
#: A contact at rest that closes by more than this fraction of the smaller body in a step is hit: an impact again.
HIT = 0.05
#: Fraction of the width of an outline's slots by which others may move past it in a substep. Gears hand over smoothly
#: up to 0.1 of a tooth, by which they go past each other by a quarter of a slot (`tests/solve/test_teeth.py`).
FEATURE = 0.15
#: Room around a shape's box, as a fraction of its size, before pairs are searched again.
MARGIN = 0.1
#: And for so many frames of its motion: what flies on is then asked about, and its box moved, in every third frame.
AHEAD = 3.0
#: A box with more than so many times that room is made smaller: what was fast and lies still is near few.
HUGE = 2.0
#: Square of the sine of the angle (8 degrees) up to which two directions are one: the next side of a chain the same
#: smooth curve for a disc that lies on it (a plastic corner of that angle would take no more than this part of its
#: energy), what lands that flat a face, and what is exposed of one the face still.
SMOOTH = 0.02
#: Where there is no weight, a contact is this many (w h)^2 stiff, h the frame: what the default penetration of a box
#: under gravity has at 60 frames a second, within a factor of 3.
WEIGHTLESS_PHASE2 = 40.0
#: Time over which the load that a pair carries is averaged (time).
LOAD_TIME = 0.5
#: And where both of its bodies are calm (time): nothing is to be smoothed there, and they come to rest the sooner.
CALM_LOAD_TIME = 0.1
#: What bears n times its own weight sinks as deep as that by sqrt(n), as round things do on one another, but by no more
#: than so many times. With depth the same under any load, the lowest of a pile of twenty layers were twenty times as
#: stiff as ten sweeps can solve: their error moved bodies by more than they overlap, and such a pile never rested.
DEEPER = 20.0
#: A joint without an error gives way by this part of its effective mass (`joint`): what hangs in one sinks by this part
#: of the way that it falls in a substep, over the part of an error that goes.
JOINT_GIVE = 1e-5
#: Of its anchors' distances, the part that is no length of a pin: it is made of positions that are rounded.
NO_LENGTH = 1e-9
#: A taut rod that swings by more than a radian in a step keeps this part of its swing: it is gone in half a second, and
#: a slow swing of the whole, of which that is a small part, in minutes.
SWINGS_ON = 0.9
#: For so many sweeps one step of the search that takes all rows together (`conjugate`), in the place of two.
SEARCH_SWEEPS = 10
#: A solve that goes on searches again, after a second time, where bounds have left the last step this part of its gain:
#: each costs as much as four sweeps.
WORTH = 0.02
#: Most steps of a search with joints: it ends sooner where it has converged, or an end lets go.
SEARCH_STEPS = 8
#: One sweep of so many, rounded up, is for the velocities that are left when positions are right (`relax`).
RELAX_SWEEPS = 5
#: A solve has not converged where the last sweep has still changed speeds by more than a part of what pushes gives in a
#: substep, and a part of the bodies' speed: a collapse is solved as far as it is seen, a pile so far that it rests.
LEFT = 0.1
MOVED = 0.003
#: It has, where a sweep has changed nothing by more than this part of what is small: the next goes on from there.
SETTLED = 5e-3
#: Energy that contacts give is no reason to solve again where it is less than this part of what they do: a solve ends
#: when a sweep changes so little (SETTLED), which gives or takes; taken back alone, elastic bodies would lose by it.
UNSOLVED_WORK = 1e-3
#: And this part of the bodies' own, where what is pressed in opens without giving speed (`relax`), as far as it is
#: solved: to a tenth (LEFT). All that is pressed in is far more where thin bodies are deep in each other.
LOOSE = 0.1
#: A speed smaller than this part of what pushes gives in a substep is rounding's, and none: a program that asks whether
#: what lies on a platform moves up is not answered by the last digit.
ROUNDING = 1e-12
#: Nobody faster, in two frames on end, than this part of what pushes gives in a frame (three of it, once it is calm):
#: such a frame is one substep. At rest the law is the same whatever the step, and what only turns round goes faster.
CALM = 0.05
#: Who has kept its place for so long is at rest, though it creeps (time; Box2D v3's b2_timeToSleep).
REST_TIME = 0.5
#: What pushes it changes by no more than this part in a frame; and it has not moved that goes no farther in a time than
#: this part of what it would fall in it: under 900 px/s^2 a pixel in half a day. It then lies within a thousandth of
#: where it would come to lie, since its load is averaged (LOAD_TIME); a stick by less than this off its balance (rad)
#: does not fall.
STILL_KICK = 1e-7
#: What a sweep still changes is this part of what is left to solve, or more: of the slowest piles.
SLOWLY = 100.0
#: In a pile that its solve has left unsolved, bodies creep by what that is wrong by: at rest there is who goes no
#: farther in REST_TIME than that, and than this part of its extent, .1 px of 20. (Box2D puts to sleep what goes five
#: times as far, solved or not: 5 cm/s, its bodies of a metre.)
STILL_WAY = 5e-3
#: Of what hardly moves, one substep in so many is solved as far as it takes to rest (STILL_KICK), the others as far as
#: is seen: they change nothing of what that one has solved.
REST_TURNS = 4
#: Of what a solve has taken from a contact's impulse, the next takes this part again before it begins: bodies that
#: brace one another go on with less in a few substeps, where the sweeps alone would need hundreds.
OVERTAKE = 0.3
#: A solve that has not converged goes on for so many times as many sweeps.
MORE_SWEEPS = 3
