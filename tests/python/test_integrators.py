"""The integrators beside the path tracer, against arrays that others made and against the path tracer itself."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pxr import Usd, UsdGeom
from umber import Session, settings
from umber.feed import feed
from umber.stage_reader import read_camera, read_stage

SHARED = Path(__file__).parents[3] / "shared"
SEED = SHARED / "reference/seed"
CHESS = SHARED / "assets/usdwg/full_assets/OpenChessSet/chess_set_cam.usda"
NOTHING = -1
AWAY = 50 / 255
FACES = [20, 80]

needs_seed = pytest.mark.skipif(not SEED.exists(), reason="the arrays are absent (../shared/reference/seed)")
needs_chess = pytest.mark.skipif(not CHESS.exists(), reason="the chess set is absent (../shared/assets/usdwg)")


def render(file: Path, size: tuple[int, int], aovs: list[str], **values: object) -> dict[str, NDArray[np.generic]]:
    """AOVs of a stage seen by its first camera, top row first."""
    stage = Usd.Stage.Open(str(file))
    time = Usd.TimeCode.EarliestTime()
    camera = next(UsdGeom.Camera(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera))
    session = Session()
    session.set("enableInteractive", "false")
    for key, value in values.items():
        known = [row["key"] for row in settings() if row["key"].rsplit(":")[-1] == key]
        session.set(known[0], str(value))
    session.camera(read_camera(camera, time))
    feed(session, read_stage(stage, time, frozenset({"render"}), lambda _: None))
    session.set_film(*size, aovs)
    session.start()
    while not session.wait(10.0):
        pass
    assert not [text for is_error, text in session.messages() if is_error]
    return {name: session.resolve(name) for name in aovs}


def sphere(faces: int, aovs: list[str], **values: object) -> dict[str, NDArray[np.generic]]:
    """AOVs of an icosphere of so many faces."""
    return render(SEED / f"icosphere_{faces}.usda", (256, 256), aovs, **values)


@needs_seed
@pytest.mark.parametrize("faces", FACES)
def test_rasterised_faces_are_those_that_rays_hit(faces: int) -> None:
    """The face of each pixel, as the AOV and as the colour of the polygon, is the one that rays hit."""
    hit = np.load(SEED / f"trace_face_{faces}.npy")
    shown = sphere(faces, ["color", "elementId"], integrator="raster", rasterColor="random")
    assert np.count_nonzero(shown["elementId"].squeeze() != hit) <= 20
    colors = np.unique(shown["color"].reshape(-1, 4), axis=0, return_inverse=True)[1].reshape(hit.shape)
    # the map that most pixels of a face say
    of_color = np.full(colors.max() + 1, NOTHING - 1)
    for face in np.unique(hit):
        of_color[np.bincount(colors[hit == face]).argmax()] = face
    assert np.count_nonzero(of_color[colors] != hit) <= 20


@needs_seed
@pytest.mark.parametrize("faces", FACES)
def test_mirror_factor(faces: int) -> None:
    """Without roughness the factor is the reference's, wherever both hit."""
    factor = np.load(SEED / f"mirror_factor_{faces}.npy")
    color = sphere(faces, ["color"], integrator="mirror", convergedSamplesPerPixel=1)["color"]
    both = (factor > -2) & (color[..., 3] > 0)
    assert np.count_nonzero(both) > 0.999 * np.count_nonzero(factor > -2) > 1000
    for channel in range(3):
        value = color[..., channel][both]
        is_factor, is_away = np.abs(value - factor[both]) <= 2e-3, np.abs(value - AWAY) <= 1e-6
        # where the factor is about zero its sign is a matter of rounding
        assert np.where(
            factor[both] > 2e-3, is_factor, np.where(factor[both] < -2e-3, is_away, is_factor | is_away)
        ).all()
    assert not color[color[..., 3] == 0].any()


def expected_value(cos: NDArray[np.float64], roughness: float) -> NDArray[np.float64]:
    """Mean value where the mirrored ray is at an angle to the light: by quadrature.

    The direction of a normal vector of deviation s around a unit vector u has, at an angle t from u, the density
    integral of r^2 exp(-(r^2 - 2 r cos t + 1) / 2 s^2) dr / (2 pi s^2)^1.5 by solid angle.
    """
    nodes, weights = np.polynomial.legendre.leggauss(400)
    radius, radius_weight = 0.5 * (nodes + 1) * (1 + 9 * roughness), 0.5 * weights * (1 + 9 * roughness)
    exponent = -(radius**2 - 2 * radius * nodes[:, None] + 1) / (2 * roughness**2)
    density = (radius_weight * radius**2 * np.exp(exponent)).sum(1) / (2 * np.pi * roughness**2) ** 1.5
    assert abs(2 * np.pi * (density * weights).sum() - 1) < 1e-6
    turn = (np.arange(2000) + 0.5) * np.pi / 2000
    means = []
    for c in cos:
        factor = nodes[:, None] * c + np.sqrt(1 - nodes[:, None] ** 2) * np.sqrt(1 - c * c) * np.cos(turn)
        value = np.where(factor > 0, factor, AWAY).mean(1)
        means.append(2 * np.pi * (density * weights * value).sum())
    return np.array(means)


@needs_seed
def test_rough_mirror_has_the_right_mean() -> None:
    """At roughness 1 the means of 50 samples scatter about the expectation, and nothing else."""
    faces, samples, runs = 80, 50, 8
    factor = np.load(SEED / f"mirror_factor_{faces}.npy").astype(np.float64)
    face = np.load(SEED / f"trace_face_{faces}.npy")
    # all of the pixel, and of its neighbours, in one face
    inner = np.ones(face.shape, bool)
    for axis in (0, 1):
        for by in (-1, 1):
            inner &= np.roll(face, by, axis) == face
    inner &= face >= 0
    pictures = [
        sphere(faces, ["color"], integrator="mirror", mirrorRoughness=1, convergedSamplesPerPixel=samples, seed=seed)
        for seed in range(runs)
    ]
    values = np.stack([picture["color"][..., 0][inner] for picture in pictures]).astype(np.float64)
    grid = np.linspace(-1, 1, 401)
    expected = np.interp(factor[inner], grid, expected_value(grid, 1.0))
    error = values - expected
    # over all pixels: one number
    deviation = error.std(ddof=1) / np.sqrt(error.size)
    assert abs(error.mean()) < 4 * deviation
    assert deviation < 2e-4
    # over each face: none is off
    z = [
        error[:, face[inner] == f].mean() / (error.std() / np.sqrt(error[:, face[inner] == f].size))
        for f in np.unique(face[inner])
    ]
    assert np.abs(z).max() < 4.5
    # and against the sampler: samples are no better spread than it can do, and no worse than independent ones
    assert error.std() < 1.05 * np.sqrt(np.mean([variance(c) for c in factor[inner][::500]]) / samples)


def variance(cos: float) -> float:
    """Variance of one value, by independent samples."""
    random = np.random.default_rng(1)
    direction = random.standard_normal((20000, 3)) + np.array([0, 0, 1])
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    factor = direction @ [np.sqrt(1 - cos * cos), 0, cos]
    return float(np.where(factor > 0, factor, AWAY).var())


@needs_chess
def test_rasterised_ids_of_the_chess_set_are_those_of_first_hits() -> None:
    """At 1920 by 1080, all but one pixel in ten thousand show the triangle's face that a ray meets."""
    ids = ["primId", "instanceId", "elementId"]
    raster, path = (
        render(CHESS, (1920, 1080), ids, integrator=integrator, convergedSamplesPerPixel=1)
        for integrator in ("raster", "path")
    )
    same = np.logical_and.reduce([raster[name] == path[name] for name in ids])
    assert np.count_nonzero(path["primId"] != NOTHING) > 500_000
    assert same.mean() >= 0.9999


@pytest.mark.parametrize("key", ["umber:integrator", "umber:rasterColor"])
def test_a_word_that_is_no_choice_is_refused_by_name(
    key: str, capfd: pytest.CaptureFixture[str], umber: Callable[..., int]
) -> None:
    """The error names key, value and the words that there are."""
    choices = next(row["choices"] for row in settings() if row["key"] == key)
    assert umber("none.usda", "out.png", "--set", f"{key}=sketch") == 2
    said = capfd.readouterr().err
    assert key in said
    assert "'sketch'" in said
    assert ", ".join(choices) in said


def test_roughness_has_a_range(capfd: pytest.CaptureFixture[str], umber: Callable[..., int]) -> None:
    """A negative one is refused."""
    assert umber("none.usda", "out.png", "--set", "umber:mirrorRoughness=-0.5") == 2
    assert "-0.5" in capfd.readouterr().err
