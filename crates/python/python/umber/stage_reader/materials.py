"""UsdPreviewSurface with constant inputs."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from pxr import UsdShade

from umber.description import Material, PreviewSurface
from umber.stage_reader.reading import Reading, single

INPUTS = {
    "diffuse_color": "diffuseColor",
    "emissive_color": "emissiveColor",
    "use_specular_workflow": "useSpecularWorkflow",
    "specular_color": "specularColor",
    "metallic": "metallic",
    "roughness": "roughness",
    "clearcoat": "clearcoat",
    "clearcoat_roughness": "clearcoatRoughness",
    "opacity": "opacity",
    "opacity_mode": "opacityMode",
    "opacity_threshold": "opacityThreshold",
    "ior": "ior",
}


def read_material(reading: Reading, material: UsdShade.Material) -> Material:
    """A material; without a UsdPreviewSurface it has no surface, and a warning says so."""
    path = material.GetPath().pathString
    shader, _, _ = material.ComputeSurfaceSource()
    if not shader:
        return Material(path)
    identifier = shader.GetIdAttr().Get()
    if identifier != "UsdPreviewSurface":
        named = f"'{identifier}'" if identifier else f"<{shader.GetPath()}> (it has no info:id)"
        reading.warn(material.GetPrim(), f"surface shader {named} is not known; meshes show their displayColor")
        return Material(path)
    surface = PreviewSurface()
    for row in fields(surface):
        value = _constant(reading, shader, INPUTS[row.name])
        if value is None:
            continue
        try:
            setattr(surface, row.name, _convert(value, getattr(surface, row.name)))
        except (TypeError, ValueError):
            kind = type(value).__name__
            reading.warn(shader.GetPrim(), f"input '{INPUTS[row.name]}' is ignored: it cannot be {value} ({kind})")
    if surface.opacity_mode not in ("transparent", "presence"):
        reading.warn(shader.GetPrim(), f"opacityMode '{surface.opacity_mode}' is not known; taken as 'transparent'")
        surface.opacity_mode = "transparent"
    return Material(path, surface)


def _convert(value: Any, like: Any) -> Any:  # noqa: ANN401
    """A USD value in the type of the field."""
    if isinstance(like, bool):
        return bool(value)
    if isinstance(like, tuple):
        if len(value) < len(like):
            raise ValueError(f"{len(like)} components are wanted")
        return tuple(single(v) for v in value[: len(like)])
    return str(value) if isinstance(like, str) else single(value)


def _constant(reading: Reading, shader: UsdShade.Shader, name: str) -> Any:  # noqa: ANN401
    """The input's value; None where nobody says any. Textures give their fallback, and a warning."""
    given = shader.GetInput(name)
    if not given:
        return None
    for attribute in UsdShade.Utils.GetValueProducingAttributes(given):
        base, kind = UsdShade.Utils.GetBaseNameAndType(attribute.GetName())
        if kind == UsdShade.AttributeType.Input:
            return attribute.Get(reading.time)
        source = UsdShade.Shader(attribute.GetPrim())
        reading.warn(
            shader.GetPrim(),
            f"input '{name}' is read from <{attribute.GetPrimPath()}>, which is not supported yet; "
            "its fallback is taken",
        )
        return _fallback(reading, source, base)
    return None


def _fallback(reading: Reading, source: UsdShade.Shader, output: str) -> Any:  # noqa: ANN401
    """What a texture or primvar reader gives where it finds nothing; None where it says nothing."""
    given = source.GetInput("fallback")
    value = given.Get(reading.time) if given else None
    channel = {"r": 0, "g": 1, "b": 2, "a": 3}.get(output)
    if value is None or channel is None or not hasattr(value, "__len__"):
        return value
    return value[channel] if channel < len(value) else None
