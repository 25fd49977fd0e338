"""Reads a whole stage: walks it once, then describes what the walk found."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from pxr import Sdf, Usd, UsdLux, UsdShade

from umber.description import Light, Prim
from umber.stage_reader.lights import geometry_targets, read_light, read_mesh_light
from umber.stage_reader.linking import Links
from umber.stage_reader.materials import read_material
from umber.stage_reader.mesh import read_mesh, subset_prims
from umber.stage_reader.reading import Reading
from umber.stage_reader.skinning import Skins
from umber.stage_reader.walk import Found, walk


def read_stage(
    stage: Usd.Stage, time: Usd.TimeCode, purposes: frozenset[str], say: Callable[[str], None]
) -> Iterator[Prim]:
    """Describes all that is shown at `time`: instancers, lights, materials, meshes.

    `purposes`: those that are shown beside the default purpose. `say` takes warnings; each names its
    prim. Meshes come one by one, so that a large stage is never held twice.
    """
    reading = Reading(stage, time, purposes, say)
    found = walk(reading)
    links = Links(_light_prims(found))
    for instancer in found.instancers:
        links.categorize(instancer, found.instance_paths.get(instancer.path, []))
        yield instancer
    geometry_lights = [prim for prim, _ in found.lights if prim.GetTypeName() == "GeometryLight"]
    yield from _lights(reading, found, links)
    materials = _bound_materials(reading, found)
    for path in sorted({path for path in materials.values() if path is not None}):
        yield read_material(reading, UsdShade.Material(stage.GetPrimAtPath(path)))
    skins = Skins(reading, found.skel_roots)
    targets = {target for prim in geometry_lights for target in geometry_targets(prim)}
    described: dict[Sdf.Path, list[str]] = {}
    prim_id = 0
    for prim, space, purpose in found.meshes:
        try:
            mesh = read_mesh(reading, prim, space, purpose, materials)
        except (TypeError, ValueError) as error:
            reading.warn(prim, f"the mesh is left out: {error}")
            continue
        if mesh is not None:
            if space.instancer is None:
                mesh.categories = links.of_path(prim.GetPath())
            skins.pose(prim, mesh)
            mesh.prim_id = prim_id
            prim_id += 1
            yield mesh
            if prim.HasAPI(UsdLux.LightAPI):
                yield _linked(links, prim, read_mesh_light(reading, prim, mesh.path))
            if prim.GetPath() in targets:
                described.setdefault(prim.GetPath(), []).append(mesh.path)
    for prim in geometry_lights:
        for light in _geometry_light(reading, prim, described):
            yield _linked(links, prim, light)


def _light_prims(found: Found) -> Iterator[Usd.Prim]:
    """All lights, meshes that are their own among them."""
    yield from (prim for prim, _ in found.lights)
    yield from (prim for prim, _, _ in found.meshes if prim.HasAPI(UsdLux.LightAPI))


def _lights(reading: Reading, found: Found, links: Links) -> Iterator[Light]:
    """The lights with a shape of their own."""
    for prim, space in found.lights:
        if prim.GetTypeName() == "GeometryLight":
            continue
        try:
            for light in read_light(reading, prim, space):
                yield _linked(links, prim, light)
        except (TypeError, ValueError) as error:
            reading.warn(prim, f"the light is left out: {error}")


def _linked(links: Links, prim: Usd.Prim, light: Light) -> Light:
    links.link(prim, light)
    return light


def _geometry_light(reading: Reading, prim: Usd.Prim, described: dict[Sdf.Path, list[str]]) -> Iterator[Light]:
    """The lights of a GeometryLight, one for each mesh; `described`: paths of the meshes by those of their prims."""
    targets = geometry_targets(prim)
    meshes = [path for target in targets for path in described.get(target, [])]
    if not meshes:
        what = ", ".join(f"<{target}>" for target in targets) or "nothing"
        reading.warn(prim, f"its geometry names no mesh that is shown ({what}): it does not shine")
    for mesh in meshes:
        yield read_mesh_light(reading, prim, mesh)


def _bound_materials(reading: Reading, found: Found) -> dict[Sdf.Path, str | None]:
    """Path of the material bound to each mesh and subset, for full renders."""
    prims = [prim for prim, _, _ in found.meshes]
    prims += [subset for prim in prims for subset in subset_prims(prim)]
    if not prims:
        return {}
    bound, _ = UsdShade.MaterialBindingAPI.ComputeBoundMaterials(prims, UsdShade.Tokens.full)
    paths = {}
    for prim, material in zip(prims, bound, strict=True):
        paths[prim.GetPath()] = material.GetPath().pathString if material else None
    return paths
