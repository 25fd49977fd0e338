"""Umber in Blender: a render engine, and light that USD files bring along and take away again."""

import bpy

# OpenUSD's Python modules are hidden until a script asks for them.
bpy.utils.expose_bundled_modules()

from . import engine, properties, ui, usd_hook

MODULES = (engine, properties, ui, usd_hook)


def register() -> None:
    """Makes the engine, its settings and the hooks known to Blender.

    Raises RuntimeError where there is no renderer to load; then nothing is registered.
    """
    for module in MODULES:
        module.register()


def unregister() -> None:
    """Takes back what `register` did. The renderer's library stays loaded: OpenUSD unloads none."""
    for module in reversed(MODULES):
        module.unregister()
