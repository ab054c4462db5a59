"""MuJoCo's contact of a flat body with a plane: what its options do, and what its soft contact makes of a slide and a spin."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from bodycheck.adapters import offers
from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported
from bodycheck.adapters.mujoco import engine as adapter
from bodycheck.adapters.mujoco import options
from bodycheck.errors import BadInput
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Scene, State
from bodycheck.reference.trajectory import Array

GRAVITY, FRICTION = 9.81, 0.5
A, B, C = 0.1, 0.2, 0.05
MASS = 2.0
MOMENTS = (MASS * (B * B + C * C) / 3, MASS * (A * A + C * C) / 3, MASS * (A * A + B * B) / 3)
PLANE = Plane(FRICTION)
RESTING = Scene(Body(MASS, MOMENTS, Brick((A, B, C))), State((0.0, 0.0, C)), GRAVITY, PLANE)
SLIDING = replace(RESTING, initial=replace(RESTING.initial, velocity=(2.0, 0.0, 0.0)))
SPINNING = replace(RESTING, initial=replace(RESTING.initial, angular_velocity=(0.0, 0.0, 10.0)))
CURLING = replace(SPINNING, initial=replace(SPINNING.initial, velocity=(1.0, 0.3, 0.0)))
PUCK = replace(CURLING, body=Body(MASS, (MASS * (3 * A * A + 4 * C * C) / 12,) * 2 + (MASS * A * A / 2,), Cylinder(A, C)))
ELLIPTIC = "Euler:cone=elliptic"
TOUCHING = [name for name in offers.offered(adapter.engine, RESTING) if name != "Euler:model=planar"]


def states(scene: Scene, name: str, timestep: float, duration: float) -> Array:
    """States (n, 13) after every step."""
    return adapter.prepare([scene], Method.parse(name, timestep)).advance(np.ones(round(duration / timestep), dtype=np.int64))[
        0, :, 0
    ]


def slide_error(name: str, timestep: float) -> float:
    """How far beyond v^2/(2 mu g) the brick has come (m)."""
    return float(states(SLIDING, name, timestep, 0.8)[-1, 0]) - 4 / (2 * FRICTION * GRAVITY)


def spin_stop(scene: Scene, name: str, timestep: float) -> float:
    """When the spin falls below a thousandth of the initial one, for good (s)."""
    spin = states(scene, name, timestep, 0.5)[:, 12]
    return float(timestep * (1 + np.flatnonzero(np.abs(spin) > 1e-3 * 10).max()))


def coulomb_stop(scene: Scene, name: str, timestep: float) -> float:
    """When the spin would stop if it lost as much as between 6 and 2 rad/s all the time (s): without the viscous end."""
    spin = states(scene, name, timestep, 0.5)[:, 12]
    return 10 / (spin[np.argmax(spin < 6)] - spin[np.argmax(spin < 2)]) * timestep * (np.argmax(spin < 2) - np.argmax(spin < 6))


def points_stop(points: Array) -> float:
    """When a spin of 10 rad/s stops on points (n, 2) that bear equal loads (s)."""
    return 10 * MOMENTS[2] / (FRICTION * MASS * GRAVITY * float(np.hypot(*points.T).mean()))


def grid(n: int) -> Array:
    """The pads (n^2, 2) under the brick (m)."""
    fractions = (2 * np.arange(n) + 1 - n) / n
    return np.stack(np.meshgrid(A * fractions, B * fractions), axis=-1).reshape(-1, 2)


def test_a_slide_ends_near_where_mechanics_has_it() -> None:
    # Measured 0.25 mm: half a step's way, -v h/2, and what is left at h = 0.
    for name in ("Euler", ELLIPTIC, "discrete"):
        assert abs(slide_error(name, 5e-4)) < 4e-4


def test_what_is_left_of_the_error_of_a_slide_does_not_vanish_with_the_step_but_with_the_softness() -> None:
    """Below v1 = mu g/b friction is viscous, with a rate b ~ 2/timeconst: that end of the slide is v1^2/(2 mu g) longer."""

    def at_no_step(name: str) -> float:
        return 2 * slide_error(name, 1e-4) - slide_error(name, 2e-4)

    floor = at_no_step(ELLIPTIC)
    # The rate is 2 d0 / (d1 timeconst) with d0 = 0.9 and d1 = 0.95; the steps of an impact leave some 10 %.
    rate = 2 * 0.9 / (0.95 * 0.02)
    assert floor == pytest.approx(FRICTION * GRAVITY / (2 * rate**2), rel=0.2)
    # A time constant a fifth as long leaves a twenty-fifth, plus what is random in the bursts of contact, 1e-5 m.
    assert abs(at_no_step(f"{ELLIPTIC},solref=0.004 1")) < floor / 25 + 2e-5


def test_a_spin_stops_when_four_corners_stop_it_and_the_viscous_end_is_over() -> None:
    assert 0.178 < spin_stop(SPINNING, ELLIPTIC, 5e-4) < 0.182
    corners = points_stop(np.array([[A, B], [-A, B], [-A, -B], [A, -B]]))
    assert corners == pytest.approx(0.152, abs=1e-3)
    # The load comes in bursts, some every 5 ms.
    assert coulomb_stop(SPINNING, ELLIPTIC, 1e-4) == pytest.approx(corners, abs=2e-3)


@pytest.mark.parametrize(("pads", "stop"), [(2, 0.328), (4, 0.230), (8, 0.202)])
def test_more_pads_do_not_bring_the_area_law(pads: int, stop: float) -> None:
    """Only the four outermost pads bear load: friction that slides pushes up in proportion to the speed at each contact."""
    name = f"{ELLIPTIC},pads={pads}"
    # Half a step, and the instant of the last burst.
    assert spin_stop(SPINNING, name, 5e-4) == pytest.approx(stop, abs=2e-3)
    outermost = points_stop((pads - 1) / pads * np.array([[A, B], [-A, B], [-A, -B], [A, -B]]))
    assert coulomb_stop(SPINNING, name, 1e-4) == pytest.approx(outermost, abs=2e-3)
    _, touching = adapter.contact_loads(SPINNING, Method.parse(name, 1e-4), 1000)
    assert touching.max() == 4


@pytest.mark.parametrize("pads", [4, 8])
def test_pads_bear_equal_loads_where_friction_hardly_pushes_up(pads: int) -> None:
    """The same mu g with a thousandth of mu: the same mechanics, and a thousandth of the push."""
    scene = replace(SPINNING, gravity=1000 * GRAVITY, plane=Plane(FRICTION / 1000))
    # The push is then b mu v / g = 94.7 * 0.0005 * 2.2 / 9810 = 1e-5 of the weight; the rest is the fit: some steps of 0.1 ms.
    assert coulomb_stop(scene, f"{ELLIPTIC},pads={pads}", 1e-4) == pytest.approx(points_stop(grid(pads)), abs=3e-4)


@pytest.mark.parametrize("name", [*TOUCHING, "Euler:noslip=5", f"{ELLIPTIC},condim=6"])
def test_a_brick_at_rest_stays(name: str) -> None:
    rows = states(RESTING, name, 1e-3, 1.0)
    # MuJoCo's solver stops at 1e-8 of its own measure of the error; the corners settle as unevenly as that.
    np.testing.assert_allclose(rows[-1, 7:], 0, atol=1e-8)
    np.testing.assert_allclose(rows[-1, :2], 0, atol=1e-7)
    assert -2e-4 < rows[-1, 2] - C < 0, "it sinks in until the soft contact bears it, g (1 - d)(timeconst)^2 at most"


@pytest.mark.parametrize("scene", [CURLING, PUCK], ids=["brick", "puck"])
@pytest.mark.parametrize(
    "name",
    [*offers.offered(adapter.engine, CURLING), "Euler:cone=elliptic,noslip=5", "discrete:cone=elliptic,pads=3", "RK4:pads=5"],
)
def test_stepping_in_pieces_is_stepping_at_once(scene: Scene, name: str) -> None:
    strides = np.array([0, 3, 0, 5, 9000, 1, 40])
    whole = adapter.prepare([scene], Method.parse(name, 1e-4)).advance(strides)
    simulation = adapter.prepare([scene], Method.parse(name, 1e-4))
    pieces = [simulation.advance(part) for part in (strides[:2], strides[2:3], strides[3:4], strides[4:])]
    np.testing.assert_array_equal(np.concatenate(pieces, axis=1), whole)
    once = adapter.prepare([scene], Method.parse(name, 1e-4))
    mujoco.set_mjcb_passive(once.force)
    try:
        mujoco.mj_step(once.model, once.data, nstep=int(strides.sum()))
    finally:
        mujoco.set_mjcb_passive(None)
    np.testing.assert_array_equal(once.rows(np.array([[*once.data.qpos, *once.data.qvel]])), whole[0, -1:, 0])


def test_the_load_is_what_carries_the_brick() -> None:
    steps, timestep = 1000, 5e-4
    for name in TOUCHING:
        load, touching = adapter.contact_loads(SPINNING, Method.parse(name, timestep), steps)
        assert load.shape == touching.shape == (steps,)
        assert (load[touching == 0] == 0).all()
        assert (load[touching > 0] > 0).all()
        if name == "RK4":
            # Its last stage, not the step's mean; and the bursts of a spin do not repeat: 2 % in 0.5 s.
            assert load.mean() == pytest.approx(MASS * GRAVITY, rel=0.05)
        else:
            end = states(SPINNING, name, timestep, steps * timestep)[-1, 9]
            # Momentum, to the rounding of 1000 steps.
            impulse = MASS * (GRAVITY * steps * timestep + end)
            assert load.sum() * timestep == pytest.approx(impulse, rel=1e-6)


def test_the_load_comes_in_bursts() -> None:
    load, touching = adapter.contact_loads(SPINNING, Method.parse(ELLIPTIC, 1e-4), 1000)
    assert load.max() > 5 * MASS * GRAVITY
    assert np.mean(touching > 0) < 0.3
    assert load.mean() == pytest.approx(MASS * GRAVITY, rel=0.05)  # a burst more or less


def test_options_are_what_the_model_has() -> None:
    name = "implicit:cone=elliptic,impratio=10,condim=4,solref=0.004 1,solimp=0.8 0.9 0.002,noslip=5"
    model = adapter.prepare([SLIDING], Method.parse(name, 1e-3)).model
    assert model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert (model.opt.impratio, model.opt.noslip_iterations) == (10, 5)
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICIT
    assert (model.geom_condim == 4).all()
    np.testing.assert_array_equal(model.geom_solref, [[0.004, 1]] * 2)
    np.testing.assert_array_equal(model.geom_solimp, [[0.8, 0.9, 0.002, 0.5, 2]] * 2)


def test_what_is_not_asked_for_is_mujocos_default() -> None:
    model, plain = adapter.prepare([SLIDING], Method.parse("Euler", 1e-3)).model, mujoco.MjModel.from_xml_string("<mujoco/>")
    for name in ("cone", "impratio", "noslip_iterations", "solver", "disableflags", "enableflags", "tolerance"):
        assert getattr(model.opt, name) == getattr(plain.opt, name), name
    np.testing.assert_array_equal(model.geom_condim, 3)


@pytest.mark.parametrize("name", ["Euler", "Euler:pads=8"])
def test_the_body_stays_that_of_the_scene(name: str) -> None:
    model = adapter.prepare([SLIDING], Method.parse(name, 1e-3)).model
    assert model.body_mass[1] == MASS
    np.testing.assert_array_equal(model.body_inertia[1], MOMENTS)
    np.testing.assert_array_equal(model.body_ipos[1], 0)
    np.testing.assert_array_equal(model.geom_friction[:, 0], FRICTION)


def test_pads_lie_in_the_lower_face() -> None:
    model = adapter.prepare([SLIDING], Method.parse("Euler:pads=3", 1e-3)).model
    assert (model.geom_type[1:] == mujoco.mjtGeom.mjGEOM_SPHERE).all()
    np.testing.assert_allclose(model.geom_pos[1:, 2] - model.geom_size[1:, 0], -C, rtol=1e-15)
    np.testing.assert_allclose(np.sort(model.geom_pos[1:, :2], axis=0), np.sort(grid(3), axis=0), rtol=1e-15, atol=1e-17)
    round_face = adapter.prepare([PUCK], Method.parse("Euler:pads=8", 1e-3)).model.geom_pos[1:, :2]
    # Of 8 x 8 cells the three in each corner have their middles outside the circle.
    assert len(round_face) == 64 - 12
    assert np.hypot(*round_face.T).max() <= A


def test_without_friction_a_body_slides_on() -> None:
    rows = states(replace(CURLING, plane=Plane(0.0)), ELLIPTIC, 1e-3, 1.0)
    # The weight's moments about a brick that sinks in evenly cancel but for rounding.
    np.testing.assert_allclose(rows[-1, [7, 8, 12]], [1.0, 0.3, 10.0], rtol=1e-9)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ("", "'' is not an option; allowed: INTEGRATOR:KEY=VALUE"),
        ("friction=1", "has no option 'friction'; allowed: model, drag, cone, impratio"),
        ("cone=round", "read 'round'; allowed: elliptic or pyramidal"),
        ("cone=elliptc", "did you mean 'elliptic'?"),
        ('cone="/>', "allowed: elliptic or pyramidal"),
        ("cone=elliptic,cone=elliptic", "cone is given twice"),
        ("impratio=0", "allowed: a positive number"),
        ("impratio=nan", "allowed: a positive number"),
        ("condim=2", "allowed: 1, 3, 4 or 6"),
        ("solref=0.02", "allowed: two numbers"),
        ("solref=0.02 -1", "allowed: two numbers"),
        ("solimp=0.9 0.95", "allowed: three or five numbers"),
        ("solimp=0.9 1.5 0.001", "impedances from 0 to 1"),
        ("noslip=-1", "allowed: a whole number >= 0"),
        ("noslip=2.5", "allowed: a whole number >= 0"),
        ("pads=0", "allowed: a whole number from 1 to 32"),
        ("pads", "'pads' is not an option"),
    ],
)
def test_options_that_are_not_allowed_are_refused(options: str, text: str) -> None:
    with pytest.raises(BadInput) as refused:
        offers.check(adapter.engine, Method.parse(f"Euler:{options}", 1e-3))
    assert text in str(refused.value)


def test_a_time_constant_that_mujoco_would_raise_is_refused() -> None:
    with pytest.raises(SceneUnsupported, match=r"MuJoCo would raise the time constant 0\.0019 s of solref to 0\.002 s"):
        adapter.prepare([SLIDING], Method.parse("Euler:solref=0.0019 1", 1e-3))


def test_numbers_are_read_as_numbers() -> None:
    method = Method.parse("Euler:solref= -1e3  -2e1,impratio=1_0,noslip=007", 1e-3)
    offers.check(adapter.engine, method)
    assert method.name == "Euler:impratio=10,noslip=7,solref=-1000 -20"
    model = adapter.prepare([SLIDING], method).model
    assert (model.opt.impratio, model.opt.noslip_iterations) == (10, 7)
    np.testing.assert_array_equal(model.geom_solref, [[-1000, -20]] * 2)


def test_a_time_constant_is_raised_by_all_integrators_but_discrete() -> None:
    """Which is why a shorter one is refused for the others; seen in the damping that MuJoCo works with, 2/(0.95 timeconst)."""
    for integrator in options.available():
        model = adapter.prepare([RESTING], Method.parse(f"{integrator}:solref=0.004 1", 2e-3)).model
        model.geom_solref[:, 0] = 0.002
        data = mujoco.MjData(model)
        data.qpos[2] = C / 2
        mujoco.mj_forward(model, data)
        raised, damping = 2 / (0.95 * 0.004), data.efc_KBIP[0, 1]
        if integrator == "discrete":
            assert damping > 1.9 * raised  # its own parametrization differs by a few percent
        else:
            assert damping == pytest.approx(raised, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("scene", "name", "text"),
    [
        (replace(SLIDING, drag=0.1), "Euler", "drag together with contact"),
        (replace(SLIDING, body=Body(MASS, MOMENTS)), "Euler", "a body without a shape touches others"),
        (SLIDING, "Euler:cone=elliptic,model=planar", "contact options cone=elliptic for the model 'planar'"),
        (replace(SLIDING, plane=Plane(1e-6)), "Euler", "least friction is 1e-05"),
        (replace(SLIDING, plane=Plane(0.0)), "Euler:condim=3", "least friction is 1e-05"),
    ],
)
def test_what_is_not_modelled_is_refused(scene: Scene, name: str, text: str) -> None:
    with pytest.raises(SceneUnsupported) as refused:
        adapter.prepare([scene], Method.parse(name, 1e-3))
    assert text in str(refused.value)
    with pytest.raises(SceneUnsupported):
        adapter.contact_loads(scene, Method.parse(name, 1e-3), 1)


def test_a_full_buffer_is_diverged(tmp_path: object, monkeypatch: pytest.MonkeyPatch) -> None:
    """A rollout stands still after any warning of MuJoCo; here, of more constraints than its buffer holds."""
    monkeypatch.chdir(tmp_path)
    method = Method.parse("Euler:noslip=5,pads=32", 1e-3)
    with pytest.raises(EngineDiverged, match=r"MuJoCo warned of CNSTRFULL at t = 0\.00"):
        adapter.prepare([RESTING], method).advance(np.array([10]))
    with pytest.raises(EngineDiverged, match="warned of CNSTRFULL"):
        adapter.contact_loads(RESTING, method, 10)
    assert not list(tmp_path.iterdir()), "MuJoCo left a log file in the working directory"


def test_what_is_offered() -> None:
    plain = offers.offered(adapter.engine, replace(SLIDING, plane=None))
    assert offers.offered(adapter.engine, SLIDING) == (*plain, ELLIPTIC, f"{ELLIPTIC},pads=4", "Euler:model=planar")
    for method, scene in (("Euler:drag=fluid", SLIDING), (ELLIPTIC, replace(SLIDING, plane=None))):
        assert "has no option" in (offers.not_offered(adapter.engine, scene, Method.parse(method, 1e-3)) or "")
