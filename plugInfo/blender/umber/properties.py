"""The delegate's settings as properties of the scene, one group for the viewport and one for final renders."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty


class Setting(NamedTuple):
    """A setting of the delegate: its key there, its property here, and what Blender is told of it."""

    key: str
    name: str
    label: str
    default: bool | int | float | str
    doc: str
    limits: Mapping[str, Any] = MappingProxyType({})


LARGEST_INT = 2**31 - 1
"""Of Blender's properties."""

INTEGRATORS = ("path", "direct", "raster", "mirror")
RASTER_COLORS = ("shaded", "random", "primId")

SAMPLING = (
    Setting(
        "convergedSamplesPerPixel",
        "samples",
        "Samples",
        64,
        "Samples a pixel at which the picture is finished",
        {"min": 1, "max": 16_777_216, "soft_max": 4096},
    ),
    Setting(
        "convergedVariance",
        "variance",
        "Variance Threshold",
        -1.0,
        "Mean relative variance of the pixels at which the picture is finished earlier, with more samples where the "
        "error is, without bias; negative: every pixel gets the same",
        {"min": -1.0, "max": 1.0, "precision": 5},
    ),
    Setting(
        "umber:timeLimit",
        "time_limit",
        "Time Limit",
        0.0,
        "Seconds of rendering after which the picture is finished as it stands; 0: no limit",
        {"min": 0.0, "max": 31_536_000.0, "soft_max": 3600.0},
    ),
    Setting("umber:seed", "seed", "Seed", 0, "Start of the sample sequence: same seed, same picture", {"min": 0}),
)
LIGHT_PATHS = (
    Setting(
        "umber:integrator",
        "integrator",
        "Integrator",
        "path",
        "How the picture is made: path follows light over all bounces, direct over one; raster projects triangles, "
        "without light; mirror gives the cosine between the reflected view ray and one direction to a light",
        {"items": [(word, word.title(), "") for word in INTEGRATORS]},
    ),
    Setting(
        "umber:maxBounces",
        "max_bounces",
        "Max Bounces",
        8,
        "Scattering events a path may have; 0 shows emission alone, 1 direct light",
        {"min": 0, "max": 1024, "soft_max": 32},
    ),
    Setting(
        "umber:rouletteBounces",
        "roulette_bounces",
        "Russian Roulette From",
        1,
        "Scattering events after which dim paths may be ended at random, without bias",
        {"min": 0, "max": 1024, "soft_max": 32},
    ),
    Setting(
        "umber:fireflyClamp",
        "firefly_clamp",
        "Firefly Clamp (Biased)",
        0.0,
        "Largest radiance that one sample of a pixel may have: hides bright specks, but their light is lost; 0: off",
        {"min": 0.0, "max": 1e30, "soft_max": 100.0},
    ),
)
ADVANCED = (
    Setting(
        "umber:pathReuse",
        "path_reuse",
        "Path Reuse",
        True,
        "Neighbouring pixels share what their paths find, without bias, where a trial at the start shows that it pays",
    ),
    Setting(
        "umber:pathSplitting",
        "path_splitting",
        "Path Splitting",
        True,
        "Several samples of a pixel begin with the same ray from the camera, without bias, where a trial at the "
        "start shows that it pays",
    ),
    Setting(
        "umber:edgeRays",
        "edge_rays",
        "Edge Rays",
        True,
        "Samples take more rays from the camera, without bias, in pixels that the rim of something bright runs through",
    ),
    Setting(
        "umber:lightTracing",
        "light_tracing",
        "Light Tracing",
        True,
        "Caustics are made by paths from smooth surfaces in the light, too, without bias, where a search at the "
        "start finds any",
    ),
    Setting(
        "umber:rasterColor",
        "raster_color",
        "Raster Color",
        "shaded",
        "What the integrator raster shows: the surface's colour lit from the eye, or a colour for each polygon or prim",
        {"items": [(word, word[0].upper() + word[1:], "") for word in RASTER_COLORS]},
    ),
    Setting(
        "umber:mirrorRoughness",
        "mirror_roughness",
        "Mirror Roughness",
        0.0,
        "Scale of the random vector that the integrator mirror adds to each reflected direction",
        {"min": 0.0, "max": 1e6, "soft_max": 1.0},
    ),
    Setting("umber:threads", "threads", "Threads", 0, "Render threads; 0 takes every core", {"min": 0, "max": 4096}),
)
SETTINGS = SAMPLING + LIGHT_PATHS + ADVANCED
"""All settings but those that Blender decides itself: enableInteractive and domeLightCameraVisibility."""


def declared(setting: Setting) -> object:
    """The declaration of the setting's property."""
    if "items" in setting.limits:
        kind = EnumProperty
    else:
        kind = {bool: BoolProperty, int: IntProperty, float: FloatProperty}[type(setting.default)]
    limits = {"max": LARGEST_INT, **setting.limits} if kind is IntProperty else setting.limits
    return kind(name=setting.label, description=setting.doc, default=setting.default, **limits)


class UmberSettings(bpy.types.PropertyGroup):
    """Settings of one way to render."""

    __annotations__ = {setting.name: declared(setting) for setting in SETTINGS}


class UmberScene(bpy.types.PropertyGroup):
    """Settings of a scene."""

    __annotations__ = {
        "final": PointerProperty(type=UmberSettings, name="Render"),
        "viewport": PointerProperty(type=UmberSettings, name="Viewport"),
    }


def by_key(group: UmberSettings) -> dict[str, object]:
    """The values of a group by the delegate's keys."""
    return {setting.key: getattr(group, setting.name) for setting in SETTINGS}


def register() -> None:
    """Gives every scene the settings, as `scene.umber`."""
    bpy.utils.register_class(UmberSettings)
    bpy.utils.register_class(UmberScene)
    bpy.types.Scene.umber = PointerProperty(type=UmberScene, name="Umber")


def unregister() -> None:
    """Takes the settings back."""
    del bpy.types.Scene.umber
    bpy.utils.unregister_class(UmberScene)
    bpy.utils.unregister_class(UmberSettings)
