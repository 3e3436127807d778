"""Every exact answer of the study's scenes against an independent formula, quadrature or solver."""

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import linprog
from shapely import Polygon

from rigidarea.study.scene import OMEGA, VX, VY, Curve, G, Trace, X, Y, scenes
from rigidarea.study.scenes import (
    arch_scene,
    bars_scene,
    bowl_roll_scene,
    bowl_slide_scene,
    box_on_box_scene,
    dome_scene,
    falling_rod_scene,
    gears_scene,
    geneva_scene,
    gripping_bounce_scene,
    heavy_on_light_scene,
    incline_up_scene,
    journal_bounce_scene,
    ladder_held_scene,
    ladder_scene,
    loop_scene,
    mass_chain_scene,
    oblique_bounce_scene,
    oblique_discs_scene,
    off_centre_hit_scene,
    overhang_scene,
    parted_scene,
    ring_on_peg_scene,
    rocking_scene,
    rough_discs_scene,
    slip_to_roll_scene,
    standing_scene,
    tipping_scene,
    v_groove_spin_scene,
    wedge_scene,
)
from rigidarea.study.scenes.bounce_scene import flight


def still(scene):
    """A trace in which nothing moves."""
    times = scene.frame * np.arange(scene.frames + 1)
    start = [(*b.position, b.angle, 0.0, 0.0, 0.0) for b in scene.bodies]
    states = np.repeat(np.array(start)[None], len(times), axis=0)
    return Trace(tuple(body.name for body in scene.bodies), times, states)


@pytest.mark.parametrize("name", list(scenes()))
def test_exact_outlines_are_the_sampled_ones(name):
    """What is taken with its arcs is what the peers get in chords."""
    for body in scenes()[name].bodies:
        for shape in body.shapes:
            if isinstance(shape, Curve) and shape.exact is not None:
                outer, *holes = shape.rings(1e-6)
                exact = shape.exact().sample(1e-6).polygon
                apart = exact.symmetric_difference(Polygon(outer, holes)).area
                assert apart < 5e-6 * exact.length


@pytest.mark.parametrize("name", list(scenes()))
def test_scene_is_consistent(name):
    """Names, frames, inertia; a trace that stands still gives a finite error, one with a NaN an infinite
    one.
    """
    scene = scenes()[name]
    assert scene.name == name
    assert scene.frames > 0
    assert len({body.name for body in scene.bodies}) == len(scene.bodies)
    for body in scene.bodies:
        if body.kind == "dynamic":
            assert body.mass > 0
            assert body.moment > 0
    assert {end for hinge in scene.hinges for end in (hinge.a, hinge.b)} <= {
        "",
        *(b.name for b in scene.bodies),
    }
    trace = still(scene)
    assert math.isfinite(scene.measure(trace))
    trace.states[-1, -1, 0] = math.nan
    assert scene.measure(trace) == math.inf


def test_errors_see_motion():
    """Standing still is right where it should be, and wrong where something should move."""
    for scene in scenes().values():
        error = scene.measure(still(scene))
        right = "rest" in scene.tags or scene.name == "superball"  # whose measure is energy
        assert (error < 1e-12) == right, scene.name


def test_bounce_flight_times():
    """The flights join: each lasts 2 v/g with v = e^n sqrt(2 g h)."""
    v = math.sqrt(2 * G * 1.0)
    for n in (1, 2, 3):
        start, stop = flight(n)
        assert stop - start == pytest.approx(2 * 0.7**n * v / G, rel=1e-12)
        assert flight(n + 1)[0] == pytest.approx(stop, rel=1e-12)


def test_oblique_bounce_by_momentum_balance():
    """Angular momentum about the point of contact is kept: friction and normal force pass through it."""
    vx, vy, omega = oblique_bounce_scene.after()
    r = oblique_bounce_scene.RADIUS
    before = -r * oblique_bounce_scene.V_T  # z of r × m v with r = (0, r), per unit mass
    after = -r * vx + r**2 / 2 * omega
    assert after == pytest.approx(before, rel=1e-12)
    assert vy == pytest.approx(oblique_bounce_scene.E * oblique_bounce_scene.V_N)
    assert vx + r * omega > 0  # the contact point still slides forwards, as the derivation assumes


def test_gripping_bounce_by_momentum_balance():
    """Angular momentum about the point of contact is kept, the rim is at rest; and the figures that were asked for."""
    vx, vy, omega = gripping_bounce_scene.after()
    r = gripping_bounce_scene.RADIUS
    assert -r * vx + r**2 / 2 * omega == pytest.approx(-r * gripping_bounce_scene.V_T, rel=1e-12)
    assert vx + r * omega == pytest.approx(0.0, abs=1e-12)
    assert (vx, omega) == pytest.approx((2 / 3, -2 / 3))
    assert vy == pytest.approx(gripping_bounce_scene.E * gripping_bounce_scene.V_N)


def test_rough_discs_keep_both_momenta():
    """Linear and angular momentum, restitution, friction on the edge of its cone and against the slip throughout."""
    module = rough_discs_scene
    scene = module.scene()
    places = np.array([body.position for body in scene.bodies])
    places[0] = places[1] - sum(module.RADII) * module.NORMAL  # where they touch
    before, after = np.zeros((2, 6)), np.zeros((2, 6))
    for states, velocities in ((before, [(module.V, 0, 0), (0, 0, 0)]), (after, module.after())):
        states[:, [X, Y]] = places
        states[:, [VX, VY, OMEGA]] = velocities
    mass = np.array(module.MASSES)
    assert mass @ after[:, [VX, VY]] == pytest.approx([module.V * mass[0], 0.0], abs=1e-12)
    assert module.angular_momentum(after) == pytest.approx(module.angular_momentum(before), rel=1e-12)
    # angular momentum about the contact point, disc by disc: the impulse has no arm about it
    for i, side in ((0, 1.0), (1, -1.0)):
        arm = -side * module.RADII[i] * module.NORMAL  # from the contact point to the centre
        inertia = module.RADII[i] ** 2 / 2
        spins = [arm[0] * s[i, VY] - arm[1] * s[i, VX] + inertia * s[i, OMEGA] for s in (before, after)]
        assert spins[0] == pytest.approx(spins[1], abs=1e-12)

    def contact(states):
        """Velocity of the first disc's contact point relative to the second's."""
        turn = states[0, OMEGA] * module.RADII[0] + states[1, OMEGA] * module.RADII[1]
        return states[0, [VX, VY]] - states[1, [VX, VY]] + turn * module.TANGENT

    first, last = contact(before), contact(after)
    assert last @ module.NORMAL == pytest.approx(-module.E * (first @ module.NORMAL))
    assert (first @ module.TANGENT) < (last @ module.TANGENT) < 0  # less slip, still the same way
    normal, tangential = module.impulses()
    assert tangential / normal == pytest.approx(module.MU)


def test_parted_measures_what_is_thrown_and_what_is_left():
    """0 for boxes that touch in the end, half the depth for those that stay, 2 u for those let go at u."""
    scene = scenes()["parted"]
    trace = still(scene)
    trace.states[:, :, Y] = parted_scene.V * trace.times[:, None]
    trace.states[:, :, X] = (-0.5, 0.5)
    assert scene.measure(trace) == pytest.approx(0.0, abs=1e-12)
    trace.states[:, :, X] = (parted_scene.DEPTH / 2 - 0.5, 0.5 - parted_scene.DEPTH / 2)
    assert scene.measure(trace) == pytest.approx(parted_scene.DEPTH / 2)
    trace.states[:, 1, X] = 0.5 + 3.0 * trace.times
    assert scene.measure(trace) == pytest.approx(2 * 3.0)


def test_heavy_crate_is_borne():
    """The two forces carry the crate, have no moment about its centre, and act where it stands on both crates."""
    left, right = heavy_on_light_scene.loads()
    assert left + right == pytest.approx(heavy_on_light_scene.RATIO * G)
    apart, off = heavy_on_light_scene.APART, heavy_on_light_scene.OFF
    assert left * (-apart - off) + right * (apart - off) == pytest.approx(0.0, abs=1e-9 * left)
    assert min(left, right) > 0


def test_box_on_box_measures_restitution():
    """A rebound at a share e of the speed is an error of e²; one that stays has none."""
    scene = scenes()["box_on_box"]
    trace = still(scene)
    hit = box_on_box_scene.hit()
    assert hit == pytest.approx(math.sqrt(2 * box_on_box_scene.DROP / G))
    falling = trace.times <= hit
    upper = 1.5 + box_on_box_scene.DROP - G * trace.times**2 / 2
    trace.states[:, 2, Y] = np.where(falling, upper, 1.5)
    assert scene.measure(trace) == 0.0
    e = 0.3
    flown = trace.times[~falling] - hit
    trace.states[~falling, 2, Y] += np.maximum(e * G * hit * flown - G * flown**2 / 2, 0)
    # frames 1/60 s apart miss the apex by g t²/2 at the most, t half a frame
    assert scene.measure(trace) == pytest.approx(e**2, abs=G / 2 / 120**2 / box_on_box_scene.DROP)


def test_ladder_held_by_a_linear_programme():
    """Forces within the cones at both ends that hold the ladder exist above the limit and do not below it."""

    def held(friction):
        """Unknown: normal and friction force at the foot, normal (to the right) and friction (up) at the wall."""
        s, c = math.sin(ladder_held_scene.STEEP), math.cos(ladder_held_scene.STEEP)
        # horizontal, vertical, moments about the centre: the foot is (c, -s)/2 from it, the top (-c, s)/2
        balance = [(0, 1, 1, 0), (1, 0, 0, 1), (c / 2, s / 2, -s / 2, -c / 2)]
        cone = [(-friction, 1, 0, 0), (-friction, -1, 0, 0), (0, 0, -friction, 1), (0, 0, -friction, -1)]
        bounds = [(0, None), (None, None)] * 2
        return linprog([0] * 4, cone, [0] * 4, balance, [0, 1, 0], bounds=bounds).status == 0

    limit = ladder_held_scene.least_friction(ladder_held_scene.STEEP)
    assert held(1.001 * limit) and not held(0.999 * limit)
    assert scenes()["ladder_held"].friction == pytest.approx(1.05 * limit)


def test_arch_against_milankovitch():
    """Sixty-one voussoirs are nearly a smooth arch, whose least t/R is 0.1075 (Milankovitch 1907); fewer have fewer
    joints to open at, and stand thinner. Less friction than a joint needs, and no thickness helps.
    """
    # the polygon's joints are 3 degrees apart, its hinge a degree and a half off: second order, 0.1 %
    assert arch_scene.least_thickness(61) == pytest.approx(0.1075, rel=2e-3)
    thinner = [arch_scene.least_thickness(n) for n in (5, 11, 61)]
    assert thinner == sorted(thinner)
    thickness = arch_scene.least_thickness() * arch_scene.RADIUS
    assert arch_scene.stands(1.01 * thickness)
    assert not arch_scene.stands(0.99 * thickness)
    assert not arch_scene.stands(2 * thickness, friction=0.2)


def test_arch_is_closed():
    """The voussoirs of the scene fill the arch without overlap, and stand on the floor."""
    import shapely

    scene = scenes()["arch"]
    stones = [
        shapely.Polygon(np.array(body.shapes[0].points) + np.array(body.position))
        for body in scene.bodies
        if body.kind == "dynamic"
    ]
    whole = shapely.union_all([stone.buffer(1e-9, join_style="mitre") for stone in stones])
    # rounding of corners of size 5 leaves films of 1e-15 m between stones
    assert whole.geom_type == "Polygon" and not whole.interiors
    assert sum(stone.area for stone in stones) == pytest.approx(whole.area, rel=1e-6)
    assert min(stone.bounds[1] for stone in stones) == pytest.approx(0.0, abs=1e-12)
    for body, stone in zip(scene.bodies[1:], stones):
        assert stone.centroid.coords[0] == pytest.approx(body.position, abs=1e-12)
        assert body.mass == pytest.approx(stone.area)


def test_incline_up_by_energy():
    """m v²/2 = (m g sin θ + μ m g cos θ) d, and it stays because tan θ < μ."""
    d = incline_up_scene.position(np.array([100.0]))[0]
    theta, mu = incline_up_scene.THETA, incline_up_scene.MU
    assert incline_up_scene.V**2 / 2 == pytest.approx(
        G * (math.sin(theta) + mu * math.cos(theta)) * d, rel=1e-12
    )
    assert math.tan(theta) < mu


def test_slip_to_roll_keeps_angular_momentum():
    """About a point of the floor: v + r ω/2 is constant (Coriolis), at every time."""
    t = np.linspace(0, 2, 41)
    x, rim = slip_to_roll_scene.motion(t)
    v = np.gradient(x, t)[1:-1]
    # central differences of a piecewise quadratic are exact but at the kink
    off = np.abs(v + rim[1:-1] / 2 - slip_to_roll_scene.V)
    assert np.sum(off > 1e-9) <= 2
    assert rim[-1] == pytest.approx(2 / 3 * slip_to_roll_scene.V)


def test_tipping_by_energy():
    """φ'²/2 = p² (cos(θ − α) − cos(φ + θ − α)); time by quadrature."""
    end = float(tipping_scene.rotation(np.array([0.0, tipping_scene.DURATION]))[-1])
    lean = tipping_scene.THETA - tipping_scene.ALPHA

    # φ = u² takes the root singularity out; near 0 the difference of cosines is u² sin(lean)
    def integrand(u):
        drop = 2 * math.sin(lean + u * u / 2) * math.sin(u * u / 2)
        return (
            2 * u / math.sqrt(2 * tipping_scene.P2 * drop)
            if u
            else 2 / math.sqrt(2 * tipping_scene.P2 * math.sin(lean))
        )

    assert quad(integrand, 0, math.sqrt(end), epsabs=1e-12)[0] == pytest.approx(
        tipping_scene.DURATION, rel=1e-9
    )


def test_rocking_quarter_period():
    """Quadrature, differential equation and, for small slender blocks, Housner's formula agree."""
    quarter = rocking_scene.quarter()
    assert rocking_scene.tilt_at(np.array([0.0, quarter]))[-1] == pytest.approx(0.0, abs=1e-10)
    # T/4 = arccosh(1/(1 − θ₀/α))/p, for a slender block (Housner 1963);
    # sin x = x (1 − x²/6): his small angles cost α²/6 = 0.6 % at most
    housner = math.acosh(1 / (1 - rocking_scene.TILT / rocking_scene.ALPHA)) / rocking_scene.P
    assert quarter == pytest.approx(housner, rel=rocking_scene.ALPHA**2 / 6)


@pytest.mark.parametrize(
    "length,amplitude", [(bowl_slide_scene.RHO, bowl_slide_scene.START), (1.5 * bowl_slide_scene.RHO, 0.7)]
)
def test_pendulum(length, amplitude):
    """Jacobi's functions against the differential equation; the period against quadrature."""
    period = bowl_slide_scene.period(length, amplitude)
    t = np.linspace(0, period, 17)
    found = solve_ivp(
        lambda _, y: (y[1], -G / length * math.sin(y[0])),
        (0, period),
        (amplitude, 0),
        t_eval=t,
        rtol=1e-11,
        atol=1e-11,
    )
    assert bowl_slide_scene.swing(t, length, amplitude) == pytest.approx(found.y[0], abs=1e-8)
    k = math.sin(amplitude / 2)
    integral = quad(lambda s: 1 / math.sqrt(1 - (k * math.sin(s)) ** 2), 0, math.pi / 2)[0]
    assert period == pytest.approx(4 * math.sqrt(length / G) * integral, rel=1e-12)


def test_rolling_pendulums_by_energy():
    """The bowl's 3/2 and the ring's 1 + I/(m R²) are kinetic energies of rolling, per unit mass and speed."""
    rho, speed = bowl_roll_scene.RHO, 1.0
    spin = speed / bowl_slide_scene.RADIUS  # rolling: the disc's rim speed equals that of its centre
    inertia = bowl_slide_scene.RADIUS**2 / 2
    assert (speed**2 + inertia * spin**2) / speed**2 * rho == pytest.approx(1.5 * rho)
    spin = speed / ring_on_peg_scene.INNER  # the ring turns about the contact at its inner radius
    energy = speed**2 + ring_on_peg_scene.GYRATION2 * spin**2
    assert energy * ring_on_peg_scene.RHO == pytest.approx(ring_on_peg_scene.LENGTH)


def test_journal_bounce():
    """Starts at the drop, touches after half a period, and bouncing on the axis is stable."""
    low = journal_bounce_scene.height(
        np.array([0.0, journal_bounce_scene.PERIOD / 2, journal_bounce_scene.PERIOD])
    )
    c, h = journal_bounce_scene.CLEARANCE, journal_bounce_scene.DROP
    assert low == pytest.approx([h - c, -c, h - c], abs=1e-12)
    assert abs(2 - 8 * h / c) < 2


def test_loop_and_dome_leave_where_the_wall_stops_pushing():
    """Energy at the moment of leaving, and N = 0 there; afterwards free fall."""
    # height of the start over the path's centre; whether the disc is inside the circle; kinetic energy at
    # first
    cases = (
        (loop_scene, -loop_scene.RHO, True, loop_scene.SPEED**2 / 2),
        (dome_scene, dome_scene.RHO * math.cos(dome_scene.START), False, 0.0),
    )
    for module, height, inside, energy in cases:
        t = np.linspace(0, module.scene().duration, 2001)
        place, left = module.motion(t)
        rho = module.RHO
        y = float(np.interp(left, t, place[:, 1]))
        v2 = 2 * (energy + G * (height - y))
        # N = 0: the weight alone bends the path, v²/ρ = g |y|/ρ; linear interpolation between times costs
        # 1e-5
        assert v2 / rho == pytest.approx(G * y / rho, rel=1e-4)
        assert np.hypot(*place[t <= left].T) == pytest.approx(rho, rel=1e-9)
        flying = place[t > left + 1e-3]
        second = np.diff(flying, 2, axis=0) / (t[1] - t[0]) ** 2
        # differences of numbers near 1 over (4e-4)²: 1e-9 of rounding each
        assert second == pytest.approx(np.tile((0.0, -G), (len(second), 1)), abs=1e-6)
        assert np.all((np.hypot(*flying.T) < rho) == inside)


def test_loop_lands_after_the_scene_ends():
    """The parabola is inside the circle until the end of the scene."""
    scene = loop_scene.scene()
    place, _ = loop_scene.motion(np.array([scene.duration]))
    assert np.hypot(*place[0]) < loop_scene.RHO


def test_v_groove_normal_forces():
    """The three balances written out as vectors, solved numerically."""
    phi, mu = v_groove_spin_scene.PHI, v_groove_spin_scene.MU
    normals = np.array([(math.sin(phi), math.cos(phi)), (-math.sin(phi), math.cos(phi))])
    # the surface moves with ω × (−r n) = −r ω (−n_y, n_x); friction is against it
    friction = mu * np.column_stack((-normals[:, 1], normals[:, 0]))
    forces = np.linalg.solve((normals + friction).T, (0.0, G))
    assert v_groove_spin_scene.normal_forces() == pytest.approx(forces, rel=1e-12)
    # torque Σ (−r n) × friction
    torque = sum(
        -v_groove_spin_scene.RADIUS * (n[0] * f[1] - n[1] * f[0]) * force
        for n, f, force in zip(normals, friction, forces)
    )
    inertia = v_groove_spin_scene.RADIUS**2 / 2
    assert torque / inertia == pytest.approx(-v_groove_spin_scene.deceleration(), rel=1e-12)
    assert (
        v_groove_spin_scene.SPIN > v_groove_spin_scene.deceleration() * v_groove_spin_scene.scene().duration
    )


def test_wedge_by_newton():
    """Unknowns: wedge's acceleration, block's relative one, the force between them."""
    s, c = math.sin(wedge_scene.SLOPE), math.cos(wedge_scene.SLOPE)
    m, big = wedge_scene.M_BLOCK, wedge_scene.M_WEDGE
    # block: m (−A + a c) = N s; m (−a s) = N c − m g; wedge: −M A = −N s
    matrix = np.array([(-m, m * c, -s), (0, -m * s, -c), (-big, 0, s)])
    found = np.linalg.solve(matrix, (0, -m * G, 0))
    assert wedge_scene.accelerations() == pytest.approx(found[:2], rel=1e-12)
    # and the block stays on the wedge until the end of the scene
    path = found[1] * wedge_scene.scene().duration ** 2 / 2
    assert 0.8 + path + wedge_scene.SIDE / 2 < wedge_scene.LENGTH / c


def test_ladder():
    """Leaving time by quadrature and by the differential equation; the wall's force vanishes there."""
    time = ladder_scene.leaving_time()
    t = np.array([0.0, time - 1e-4, time, time + 1e-4])
    theta = ladder_scene.angle_at(t)
    assert theta[2] == pytest.approx(ladder_scene.leaving_angle(), abs=1e-9)
    x = np.cos(theta[1:])
    # the wall pushes with m x''; second difference of step 1e-4 with angles to 1e-12: good to 1e-3
    assert (x[0] - 2 * x[1] + x[2]) / 1e-8 == pytest.approx(0.0, abs=5e-3)
    h, thick = ladder_scene.LENGTH / 2, ladder_scene.THICK / 2
    second = quad(lambda y: (1 - abs(y)) * y * y, -1, 1)[
        0
    ]  # of a rhombus about a diagonal, per area and height²
    assert ladder_scene.moment(1.0) == pytest.approx(second * (h**2 + thick**2), rel=1e-9)


def test_falling_rod_by_energy():
    """Kinetic plus potential energy is constant along the solution."""
    t = np.linspace(0, falling_rod_scene.scene().duration, 2001)
    theta = falling_rod_scene.angle_at(t)
    rate = np.gradient(theta, t)
    energy = (ladder_scene.moment(1.0) + np.cos(theta) ** 2) * rate**2 / 2 + G * np.sin(theta)
    assert energy[5:-5] == pytest.approx(np.full(1991, energy[0]), rel=1e-5)  # second-order differences
    # the tip, not the flat side, touches: the sides lean atan(thickness/length) from the axis
    assert theta[-1] > math.atan(ladder_scene.THICK / ladder_scene.LENGTH)


def test_impacts_keep_momentum():
    """Linear (and angular) momentum, and the asked coefficient of restitution."""
    velocities = oblique_discs_scene.after()
    assert velocities.sum(axis=0) == pytest.approx([oblique_discs_scene.V, 0.0], abs=1e-12)
    normal = np.array((math.cos(oblique_discs_scene.SLANT), math.sin(oblique_discs_scene.SLANT)))
    separation = (velocities[1] - velocities[0]) @ normal
    assert separation == pytest.approx(oblique_discs_scene.E * oblique_discs_scene.V * normal[0])

    j = off_centre_hit_scene.impulse()
    disc, bar, omega = -3.0 + j, -j / 2, -0.6 * j / off_centre_hit_scene.I_BAR
    assert disc - (bar + 0.6 * omega) == pytest.approx(off_centre_hit_scene.E * 3.0)

    speeds, masses = mass_chain_scene.after(), np.array(mass_chain_scene.MASSES)
    assert masses @ speeds == pytest.approx(mass_chain_scene.V)
    assert masses @ speeds**2 == pytest.approx(mass_chain_scene.V**2)
    assert np.all(np.diff(speeds) > 0)  # none catches the next one up


def test_bars_by_waves():
    """Saint-Venant's answer from the wave equation, d'Alembert's two waves moved cell by cell (exact for h = c Δt)."""
    short, long = 40, 80
    right, left = (
        np.zeros(short + long),
        np.zeros(short + long),
    )  # velocity is their sum, pressure their difference
    right[:short] = left[:short] = bars_scene.V / 2
    for _ in range(6 * long):
        from_short, from_long = right[short - 1], left[short]
        onwards, back = np.empty_like(right), np.empty_like(left)
        onwards[1:], back[:-1] = right[:-1], left[1:]
        onwards[0], back[-1] = left[0], right[-1]  # free ends reflect
        if from_short < from_long:  # tension: the joint opens, two free ends
            onwards[short], back[short - 1] = from_long, from_short
        right, left = onwards, back
    velocity = right + left
    means = velocity[:short].mean(), velocity[short:].mean()
    assert means == pytest.approx(bars_scene.after(), abs=1e-12)


def test_overhang_is_stable():
    """The centre of mass of everything above each edge is inside it, by a tenth of what the limit allows."""
    centres = overhang_scene.centres()
    half = overhang_scene.LENGTH / 2
    edges = np.concatenate(([0.0], centres[:-1] + half))
    for i, edge in enumerate(edges):
        inside = edge - centres[i:].mean()
        assert inside > 0
        assert inside == pytest.approx(0.1 * half / (len(centres) - i), abs=0.1 * half)


def test_geneva_angle():
    """The scene's formula against the geometry: the pin lies on the slot's centre line."""
    parts = geneva_scene.drive()
    crank = np.linspace(-parts.entry_angle - 0.2, parts.entry_angle + 0.2, 41)
    moved = geneva_scene.wheel_angle(crank)
    start = parts.wheel_angle(float(crank[0]))
    assert start + moved == pytest.approx([parts.wheel_angle(float(c)) for c in crank], abs=1e-12)
    for c, angle in zip(crank, start + moved):
        if abs(c) < parts.entry_angle:
            pin = parts.crank_radius * np.array((math.cos(c), math.sin(c))) - (geneva_scene.CENTRES, 0.0)
            assert math.atan2(pin[1], pin[0]) == pytest.approx(math.remainder(angle, 2 * math.pi), abs=1e-9)


def test_gears_start_touching():
    """At the start the exact flanks of the scene touch and do not overlap."""
    import shapely
    from shapely.affinity import rotate, translate

    scene = gears_scene.scene()
    driver, driven = (shapely.Polygon(body.shapes[0].rings(1e-6)[0]) for body in scene.bodies)
    body = scene.bodies[1]

    def placed(more):
        return translate(rotate(driven, body.angle + more, (0, 0), use_radians=True), *body.position)

    # Facets of 1e-6 m: overlap of a film of a few of them at most; a hundredth of the backlash more and it
    # cuts.
    film = driver.intersection(placed(0.0)).area
    play = gears_scene.BACKLASH * gears_scene.MODULE
    assert film < 1e-6 * 0.2
    pressed = driver.intersection(placed(0.05 * play / gears_scene.RADII[1])).area
    apart = driver.intersection(placed(-0.05 * play / gears_scene.RADII[1])).area
    assert apart == 0.0 or pressed == 0.0
    assert max(apart, pressed) > 3 * film


def test_standing_falls_on_too_soft_a_bed():
    """About where statics says, on a bed that lets the width, lying flat, sink by a part m³ w/6h of it: twice as
    soft it tips over within the scene's time (at half as soft again it still leans by 0.03), at half it stands.

    The weight lies a part m of half the base from the lower edge, m w/2. Turned by φ the block is pressed along c from
    that edge, with k c²/2 φ = m g where k = m g/(p w²), and the resultant is c/3 from it: m w/2 − φ h/2 = c/3. So
    (m w/2 − φ h/2)² φ = 2 p w²/9, whose left side is at most (4/27) (m w/2)³/(h/2), where φ = m w/3h.
    """
    from rigidarea.study.peers import get_peer, record

    scene = scenes()["standing"]

    def error(penetration):
        run = get_peer("rigidarea").build(scene, {"penetration": penetration, "steps": 2})
        return scene.measure(record(run, scene))

    slender = standing_scene.WIDTH / standing_scene.HEIGHT
    limit = (1.0 - math.tan(standing_scene.THETA) / slender) ** 3 * slender / 6.0
    assert limit == pytest.approx(8.33e-5, rel=1e-3)
    assert error(0.5 * limit) < 0.01
    assert error(2.0 * limit) > 1.0
