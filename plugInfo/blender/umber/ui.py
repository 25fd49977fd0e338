"""Panels: the settings of a render, and which of Blender's own panels show with Umber."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from .engine import UmberEngine
from .properties import ADVANCED, LIGHT_PATHS, SAMPLING, SETTINGS, Setting

HIDDEN = {"DATA_PT_light", "NODE_DATA_PT_light", "DATA_PT_falloff_curve", "RENDER_PT_freestyle"}
"""Panels of Blender's built-in set that mean nothing here."""

BORROWED = {
    "DATA_PT_EEVEE_light",
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_settings",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "MATERIAL_PT_preview",
}
"""Panels of EEVEE that mean the same here."""


class Panel:
    """What Umber's panels in the render properties have in common."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether Umber renders the scene."""
        return context.engine == UmberEngine.bl_idname

    def aligned(self) -> bpy.types.UILayout:
        """The layout, with names on the left."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout

    def show(self, group: bpy.types.PropertyGroup, settings: tuple[Setting, ...]) -> None:
        """A row for each of the settings."""
        column = self.aligned().column()
        for setting in settings:
            column.prop(group, setting.name)


class UMBER_RENDER_PT_scene(Panel, bpy.types.Panel):
    """How Blender hands the scene over."""

    bl_label = "Scene"

    def draw(self, context: bpy.types.Context) -> None:
        """Blender's choice, and what depends on it."""
        layout, hydra = self.aligned(), context.scene.hydra
        layout.prop(hydra, "export_method")
        if hydra.export_method != "USD":
            layout.label(text="Light linking and lights that USD files brought need USD", icon="INFO")


class UMBER_RENDER_PT_sampling(Panel, bpy.types.Panel):
    """Sampling of final renders."""

    bl_label = "Sampling"

    def draw(self, context: bpy.types.Context) -> None:
        """Settings of the final render."""
        self.show(context.scene.umber.final, SAMPLING)


class UMBER_RENDER_PT_paths(Panel, bpy.types.Panel):
    """Light paths of final renders."""

    bl_label = "Light Paths"

    def draw(self, context: bpy.types.Context) -> None:
        """Settings of the final render."""
        self.show(context.scene.umber.final, LIGHT_PATHS)


class UMBER_RENDER_PT_advanced(Panel, bpy.types.Panel):
    """What is seldom changed."""

    bl_label = "Advanced"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: bpy.types.Context) -> None:
        """Settings of the final render."""
        self.show(context.scene.umber.final, ADVANCED)


class UMBER_RENDER_PT_viewport(Panel, bpy.types.Panel):
    """The viewport's own settings."""

    bl_label = "Viewport"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: bpy.types.Context) -> None:
        """Settings of the viewport."""
        self.show(context.scene.umber.viewport, SETTINGS)


class UMBER_RENDER_PT_film(Panel, bpy.types.Panel):
    """The background."""

    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: bpy.types.Context) -> None:
        """Whether the camera sees the world and the disks of suns."""
        self.aligned().prop(context.scene.render, "film_transparent", text="Transparent")


class UMBER_LIGHT_PT_shadow(Panel, bpy.types.Panel):
    """What EEVEE's light panel, which shows here too, leaves to its own panel of shadows."""

    bl_label = "Shadow"
    bl_context = "data"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the object is a light."""
        return super().poll(context) and context.light is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Whether there are any."""
        self.aligned().prop(context.light, "use_shadow", text="Cast Shadows")


class UMBER_VIEWLAYER_PT_passes(Panel, bpy.types.Panel):
    """Passes of a view layer."""

    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context: bpy.types.Context) -> None:
        """The passes that the engine fills."""
        column = self.aligned().column(heading="Include", align=True)
        column.prop(context.view_layer, "use_pass_combined")
        column.prop(context.view_layer, "use_pass_z")


PANELS = (
    UMBER_RENDER_PT_scene,
    UMBER_RENDER_PT_sampling,
    UMBER_RENDER_PT_paths,
    UMBER_RENDER_PT_advanced,
    UMBER_RENDER_PT_viewport,
    UMBER_RENDER_PT_film,
    UMBER_LIGHT_PT_shadow,
    UMBER_VIEWLAYER_PT_passes,
)


def shared_panels() -> Iterator[set[str]]:
    """The engines of each of Blender's panels that show with Umber: generic ones, and some of EEVEE's.

    The light linking panels are among the generic ones, by their parent.
    """
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", ())
        generic = "BLENDER_RENDER" in engines and panel.__name__ not in HIDDEN
        if generic or ("BLENDER_EEVEE" in engines and panel.__name__ in BORROWED):
            yield engines


def register() -> None:
    """Shows the panels."""
    for panel in PANELS:
        bpy.utils.register_class(panel)
    for engines in shared_panels():
        engines.add(UmberEngine.bl_idname)


def unregister() -> None:
    """Takes the panels back."""
    for engines in shared_panels():
        engines.discard(UmberEngine.bl_idname)
    for panel in reversed(PANELS):
        bpy.utils.unregister_class(panel)
