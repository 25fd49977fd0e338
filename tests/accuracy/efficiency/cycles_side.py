"""Cycles' side: see `side.py`. Set up by the tool beside the project: box filter, no clamps, no denoising."""

from __future__ import annotations

import os
import runpy
import sys
from pathlib import Path
from typing import Any

from numpy.typing import NDArray
from side import BOUNCES, serve

TOOL = Path(__file__).parents[4] / "shared/tools/cycles_peer.py"


# By which Blender's importer multiplies a distant light's intensity.
SUN_FACTOR = 4.0


def give_worlds() -> None:
    """Gives every new scene a world: Blender reads dome lights into it, and loses them where there is none."""
    import bpy  # noqa: PLC0415 - in this interpreter alone

    @bpy.app.handlers.persistent
    def give(*_: object) -> None:
        for scene in bpy.data.scenes:
            if scene.world is None:
                scene.world = bpy.data.worlds.new("World")
                # black, unless there is a dome
                for node in scene.world.node_tree.nodes:
                    if node.type == "BACKGROUND":
                        node.inputs["Color"].default_value = (0, 0, 0, 1)

    bpy.app.handlers.load_post.append(give)
    bpy.app.handlers.load_factory_startup_post.append(give)


def main() -> None:
    """Serves."""
    give_worlds()
    if not TOOL.exists():
        sys.exit(f"no {TOOL}")
    file, width, height = sys.argv[1:]
    # it takes a reference and a picture of one sample each, which warms it up, and leaves its names
    sys.argv = [str(TOOL), file, "--size", width, height, "--bounces", str(BOUNCES), "--reference", "1", "--spp", "1"]
    tool = runpy.run_path(str(TOOL), run_name="__main__")
    # without normals a mesh is flat in USD, and smooth in Blender
    for mesh in tool["bpy"].data.meshes:
        if not mesh.has_custom_normals:
            mesh.shade_flat()
    # Blender's importer makes suns brighter than UsdLux has them
    for light in tool["bpy"].data.lights:
        if light.type == "SUN":
            light.energy /= SUN_FACTOR
    # what is loaded stays loaded: the time of a picture is not that of building the scene again
    tool["scene"].render.use_persistent_data = True
    render = tool["render"]

    def take(request: dict[str, Any]) -> tuple[NDArray[Any], dict[str, float]]:
        picture, seconds = render(request["samples"], request["seed"])
        return picture, {"seconds": seconds, "samples": request["samples"]}

    serve(f"Cycles, Blender {tool['bpy'].app.version_string}", take)
    sys.stdout.flush()
    os._exit(0)  # Blender as a module is not always able to end


if __name__ == "__main__":
    main()
