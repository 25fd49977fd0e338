"""No more than a scene needs: what the parts of a picture cost, and what features cost that a scene does not use.

The first (`costs`) renders a scene with one thing changed at a time, and gives seconds, rays a sample and what Umber
reports of the scene.

The second (`unused`) cannot leave features out of the build. It measures from the other side: a Lambertian room, beside
the same room with one feature present where no ray meets it, in a closed box behind the back wall. The renderer then
has to look for the feature wherever it may occur; without it, the same code finds at once that there is none. What the
presence costs bounds what the looking costs; it says nothing of what the mere size of the code does to the processor's
caches. Both render in turn, on one thread, timed by the processor time of the process, which other processes disturb
less than the clock; compared are the fastest of each, since whatever disturbs only adds. The pictures have to be the
same bit by bit, or rays have met the box.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import stages
from numpy.typing import NDArray
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, Vt
from umber import Session
from umber_side import load

# The most that a feature which the scene does not use may cost, in parts of the time.
BAR = 1.02


@dataclass(frozen=True)
class Part:
    """A way to render a scene that leaves something out, or adds it."""

    name: str
    settings: dict[str, str] = field(default_factory=dict)
    aovs: tuple[str, ...] = ("color",)


ALL_AOVS = ("color", "depth", "cameraDepth", "normal", "Neye", "primId", "instanceId", "elementId")
WHOLE = "as it is"
PARTS = [
    Part(WHOLE),
    Part("what the camera sees, unlit", {"umber:maxBounces": "0"}),
    Part("and direct light", {"umber:maxBounces": "1"}),
    Part("no Russian roulette", {"umber:rouletteBounces": "1024"}),
    Part("eight AOVs for one", aovs=ALL_AOVS),
]


def _render(session: Session, samples: int, seed: int) -> dict[str, Any]:
    """A picture's figures; `cpu_seconds` beside them."""
    session.set("convergedSamplesPerPixel", str(samples))
    session.set("umber:seed", str(seed))
    before = time.process_time()
    session.start()
    while not session.wait(10.0):
        pass
    return {**session.stats(), "cpu_seconds": time.process_time() - before}


def _set(session: Session, part: Part, size: tuple[int, int]) -> None:
    for key in {key for other in PARTS for key in other.settings}:
        session.set(key, part.settings.get(key, "8" if key == "umber:maxBounces" else "3"))
    session.set_film(*size, list(part.aovs))


def costs(stage: Path, size: tuple[int, int], samples: int, rounds: int) -> dict[str, Any]:
    """What each part of the scene's picture takes, by nanoseconds of the processor a sample, and rays a sample."""
    session = load(str(stage), *size)
    taken: dict[str, list[dict[str, Any]]] = {part.name: [] for part in PARTS}
    _render(session, 1, 0)  # compiles the scene
    reported = session.stats()
    for round_number in range(rounds):
        for part in PARTS:
            _set(session, part, size)
            taken[part.name].append(_render(session, samples, round_number))
    count = size[0] * size[1] * samples
    rows = [
        {
            "name": name,
            "ns_a_sample": statistics.median(1e9 * t["cpu_seconds"] / count for t in by_round),
            "rays_a_sample": by_round[0]["rays"] / count,
        }
        for name, by_round in taken.items()
    ]
    return {"samples": samples, "rounds": rounds, "parts": rows, "reported": reported}


BOX = "/World/Box"
Feature = Callable[[Usd.Stage], object]


def _sphere(stage: Usd.Stage, name: str = "Sphere") -> UsdGeom.Mesh:
    points, triangles = stages.bumpy_sphere(2)
    return stages.add_mesh(stage, f"{BOX}/{name}", 0.1 * points + [0, 0, -2], triangles, (0.5, 0.5, 0.5))


def _material(stage: Usd.Stage, inputs: dict[str, float]) -> None:
    mesh = _sphere(stage)
    material = UsdShade.Material.Define(stage, f"{BOX}/Look")
    shader = UsdShade.Shader.Define(stage, f"{BOX}/Look/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    for name, value in inputs.items():
        shader.CreateInput(name, Sdf.ValueTypeNames.Float).Set(value)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)


def _instances(stage: Usd.Stage) -> None:
    instancer = UsdGeom.PointInstancer.Define(stage, f"{BOX}/Many")
    points, triangles = stages.bumpy_sphere(1)
    mesh = stages.add_mesh(stage, f"{BOX}/Many/One", 0.02 * points, triangles, (0.5, 0.5, 0.5))
    instancer.CreatePrototypesRel().AddTarget(mesh.GetPath())
    places = [Gf.Vec3f(x / 10, y / 10, -2) for x in range(-2, 3) for y in range(-2, 3)]
    instancer.CreatePositionsAttr(Vt.Vec3fArray(places))
    instancer.CreateProtoIndicesAttr(Vt.IntArray([0] * len(places)))


def _light(stage: Usd.Stage) -> UsdLux.LightAPI:
    light = UsdLux.RectLight.Define(stage, f"{BOX}/Lamp")
    light.AddTranslateOp().Set(Gf.Vec3d(0, 0, -1.7))
    light.CreateWidthAttr(0.05)
    light.CreateHeightAttr(0.05)
    api = UsdLux.LightAPI(light.GetPrim())
    links = api.GetLightLinkCollectionAPI()
    links.CreateIncludeRootAttr(False)
    links.CreateIncludesRel().AddTarget(_sphere(stage).GetPath())
    return api


def _shadow_link(stage: Usd.Stage) -> None:
    shadows = _light(stage).GetShadowLinkCollectionAPI()
    shadows.CreateIncludeRootAttr(True)
    shadows.CreateExcludesRel().AddTarget(_sphere(stage, "Unshadowed").GetPath())


# What the box holds. `nothing` is the box alone: the noise of the measure.
FEATURES: dict[str, Feature] = {
    "nothing": lambda stage: None,
    "a rough metal": lambda stage: _material(stage, {"metallic": 1.0, "roughness": 0.3}),
    "clear coat over plastic": lambda stage: _material(stage, {"clearcoat": 1.0, "roughness": 0.4}),
    "half opacity": lambda stage: _material(stage, {"opacity": 0.5}),
    "a PointInstancer": _instances,
    "a light linked to what is in the box": lambda stage: _light(stage),
    "the same with linked shadows": _shadow_link,
}


def _room(base: Path, file: Path, feature: Feature) -> Path:
    """The base stage, and a closed box behind it with a feature in it."""
    stage = stages.new_stage(file)
    stage.GetRootLayer().subLayerPaths.append(str(base.resolve()))
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])
    stages.add_mesh(stage, f"{BOX}/Walls", 0.5 * corners + [0, 0, -2], triangles, (0.5, 0.5, 0.5))
    feature(stage)
    return stages.save(stage, file)


@dataclass
class _Room:
    session: Session
    seconds: list[float] = field(default_factory=list)
    picture: NDArray[np.float32] = field(default_factory=lambda: np.zeros(0, np.float32))
    rays: float = 0.0

    def take(self, samples: int) -> None:
        self.session.set("umber:seed", "1")  # what is rendered already is not rendered again, unless a setting changed
        figures = _render(self.session, samples, 0)
        self.seconds.append(float(figures["cpu_seconds"]))
        self.rays = float(figures["rays"])
        self.picture = self.session.resolve("color")


def unused(base: Path, folder: Path, size: tuple[int, int], samples: int, rounds: int) -> dict[str, Any]:
    """By feature: processor time with it over that without, the median of rounds; and their quartiles.

    Many short rounds: what else the processor does then meets both pictures of a round alike.
    """
    rooms: dict[str, _Room] = {}
    for name, feature in {"": FEATURES["nothing"], **FEATURES}.items():
        stage = _room(base, folder / f"room_{len(rooms)}.usda", feature)
        rooms[name] = _Room(load(str(stage), *size))
        rooms[name].session.set("umber:threads", "1")
        _render(rooms[name].session, 1, 0)  # compiles the scene
    rows = []
    for name in FEATURES:
        plain, room = rooms[""], rooms[name]
        ratios: list[float] = []
        plain.seconds.clear()
        for round_number in range(rounds):
            # whoever is first meets caches that the other has left: turn about
            order = (plain, room) if round_number % 2 else (room, plain)
            for one in order:
                one.take(samples)
            ratios.append(room.seconds[-1] / plain.seconds[-1])
        first, median, third = statistics.quantiles(ratios, n=4, method="inclusive")
        rows.append(
            {
                "name": name,
                "ratio": median,
                "quartiles": [first, third],
                "same_picture": bool(np.array_equal(plain.picture, room.picture)) and plain.rays == room.rays,
            }
        )
    return {"bar": BAR, "samples": samples, "rounds": rounds, "size": list(size), "features": rows}
