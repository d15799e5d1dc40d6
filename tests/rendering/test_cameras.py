import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonargparse import auto_cli
from mesh_shapes import blob, camera_at, ellipsoid

from normalgan.rendering.cameras import Camera, Views, framed, look_at_origin

Axis = tuple[int, int, int]


def project(camera: Camera, points: np.ndarray) -> np.ndarray:
    """Return normalised device coordinates (P, 3) by the camera's matrices."""
    clip = np.c_[points, np.ones(len(points))] @ (camera.projection_matrix() @ camera.view_matrix()).T
    return np.asarray(clip[:, :3] / clip[:, 3:])


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), margin=st.floats(0, 0.4), perspective=st.sampled_from([0.0, 1.0]))
def test_the_object_fills_the_frame_and_is_never_clipped(
    seed: int, margin: float, perspective: float
) -> None:
    views = Views(elevation=(-90, 90), roll=(-180, 180), perspective=perspective, margin=margin)
    views = Views(**{**vars(views), "field_of_view": (5, 110)})
    seen = project(views.camera(blob(), np.random.default_rng(seed)), blob().vertices)
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
    assert low + high == pytest.approx([0, 0], abs=1e-9)
    assert (high - low).max() == pytest.approx(2 * (1 - 2 * margin))
    assert np.abs(seen[:, 2]).max() < 1


@pytest.mark.parametrize("field_of_view", [None, 35.0])
def test_rays_pass_where_the_matrices_project(field_of_view: float | None) -> None:
    camera = camera_at(blob(), field_of_view=field_of_view)
    origins, directions = camera.rays(5)
    assert origins.shape == directions.shape == (5, 5, 3)
    for depth in (1.7, 3.0):
        seen = project(camera, (origins + depth * directions).reshape(-1, 3)).reshape(5, 5, 3)
        centres = (np.arange(5) + 0.5) / 5 * 2 - 1
        np.testing.assert_allclose(seen[..., 0], np.broadcast_to(centres, (5, 5)), atol=1e-12)
        np.testing.assert_allclose(seen[..., 1], np.broadcast_to(-centres[:, None], (5, 5)), atol=1e-12)
        at = (origins + depth * directions).reshape(-1, 3) @ camera.rotation.T + camera.translation
        np.testing.assert_allclose(at[:, 2], -depth, atol=1e-12)


@pytest.mark.parametrize("field_of_view", [None, 35.0])
def test_near_and_far_planes_are_the_ends_of_clip_space(field_of_view: float | None) -> None:
    camera = camera_at(blob(), field_of_view=field_of_view)
    on_axis = np.array([[0, 0, -camera.near], [0, 0, -camera.far]])
    world = (on_axis - camera.translation) @ camera.rotation
    assert project(camera, world)[:, 2] == pytest.approx([-1, 1])


@pytest.mark.parametrize(
    ("azimuth", "elevation", "roll", "right", "up", "to_viewer"),
    [
        (0, 0, 0, (1, 0, 0), (0, 1, 0), (0, 0, 1)),
        (90, 0, 0, (0, 0, -1), (0, 1, 0), (1, 0, 0)),
        (0, 90, 0, (1, 0, 0), (0, 0, -1), (0, 1, 0)),
        # The picture turned counter-clockwise: what was on the right is now on top.
        (0, 0, 90, (0, -1, 0), (1, 0, 0), (0, 0, 1)),
    ],
)
def test_angles_mean_what_they_say(
    azimuth: float, elevation: float, roll: float, right: Axis, up: Axis, to_viewer: Axis
) -> None:
    rotation = look_at_origin(azimuth, elevation, roll)
    np.testing.assert_allclose(rotation, [right, up, to_viewer], atol=1e-12)


def test_the_eye_sees_the_bounding_sphere_under_the_field_of_view() -> None:
    mesh = ellipsoid(1, 1, 1)
    camera = camera_at(mesh, field_of_view=40)
    assert np.rad2deg(2 * np.arcsin(1 / np.linalg.norm(camera.translation))) == pytest.approx(40, rel=1e-4)
    left, right, bottom, top = camera.window
    assert np.rad2deg(2 * np.arctan((right - left) / 2 * 0.88)) == pytest.approx(40, rel=1e-2)
    assert right - left == pytest.approx(top - bottom)


def test_the_share_of_perspective_views_is_kept() -> None:
    rng = np.random.default_rng(0)
    views = Views(perspective=0.3)
    drawn = [views.camera(ellipsoid(1, 1, 1, 1), rng).perspective for _ in range(1000)]
    assert np.mean(drawn) == pytest.approx(0.3, abs=0.05)


def test_a_view_depends_on_the_generator_alone_and_settings_do_not_shift_each_other() -> None:
    one, same, other = (
        views.camera(blob(), np.random.default_rng(7))
        for views in (Views(perspective=0), Views(perspective=0), Views(perspective=1, margin=0.2))
    )
    np.testing.assert_array_equal(one.rotation, same.rotation)
    assert one.window == same.window
    np.testing.assert_array_equal(one.rotation, other.rotation)
    assert (one.perspective, other.perspective) == (False, True)


def test_a_line_seen_end_on_still_gets_a_frame() -> None:
    line = np.array([[0, 0, -1.0], [0, 0, 1.0]])
    left, right, bottom, top = framed(line, np.eye(3), None, 0.1).window
    assert right > left
    assert top > bottom


def test_views_can_be_given_in_a_config_file() -> None:
    def command(views: Views = Views()) -> Views:  # noqa: B008
        return views

    given = auto_cli(command, args=["--views.azimuth=[0, 90]", "--views.perspective=0.25"])
    assert given == Views(azimuth=(0, 90), perspective=0.25)
