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


def main() -> None:
    """Serves."""
    if not TOOL.exists():
        sys.exit(f"no {TOOL}")
    file, width, height = sys.argv[1:]
    # it takes a reference and a picture of one sample each, which warms it up, and leaves its names
    sys.argv = [str(TOOL), file, "--size", width, height, "--bounces", str(BOUNCES), "--reference", "1", "--spp", "1"]
    tool = runpy.run_path(str(TOOL), run_name="__main__")
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
