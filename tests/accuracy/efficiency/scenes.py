"""The scenes of the measures: where their stages come from, and what is true of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import stages

SHARED = Path(__file__).parents[4] / "shared"


@dataclass(frozen=True)
class Scene:
    """A stage, and how it is shown."""

    name: str
    size: tuple[int, int]
    # what it is made from; a scene whose source is absent is left out
    source: Path | None
    # writes the stage that is measured to a file; None: the source itself is measured
    make: Callable[[Path], Path] | None = None
    # Mitsuba's picture of it that is kept; None: one is rendered, of at most so many samples a pixel in each half
    reference: Path | None = None
    reference_samples: int = 1 << 16
    # whether Blender reads the very same light and surfaces; else Cycles is measured against itself
    same_in_cycles: bool = False
    # peers that take no part, and why
    left_out: Mapping[str, str] = field(default_factory=dict)

    def stage(self, folder: Path) -> Path:
        """The stage; one that is made lies in the folder, and is made once for each state of this package."""
        if self.make is None:
            if self.source is None:
                raise ValueError(f"{self.name} has neither a stage nor a maker")
            return self.source
        file = folder / f"{self.name}.usdc"
        makers = Path(stages.__file__).stat().st_mtime
        if not file.exists() or file.stat().st_mtime < max(makers, Path(__file__).stat().st_mtime):
            print(f"{self.name}: making its stage", flush=True)
            self.make(file)
        return file


def _given(name: str, size: tuple[int, int]) -> Scene:
    return Scene(name, size, SHARED / f"scenes/{name}.usda", reference=SHARED / f"reference/mitsuba/{name}.npy")


_ICOSPHERE = SHARED / "reference/seed/icosphere_80.usda"
_CHESS = SHARED / "assets/usdwg/full_assets/OpenChessSet/chess_set_cam.usda"
_HDRI = SHARED / "assets/hdri"
_APARTMENT = SHARED / "assets/gltf_cc/dream-apartment/dream-apartment_cam.usda"

# Those with Mitsuba's references at hand.
GIVEN = [_given("cornell", (256, 256)), _given("metal", (320, 180)), _given("many_lights", (320, 180))]

SCENES = [
    Scene("icosphere", (256, 256), _ICOSPHERE, lambda file: stages.icosphere(_ICOSPHERE, file), same_in_cycles=True),
    *GIVEN,
    Scene(
        "chess",
        (320, 180),
        _CHESS,
        lambda file: stages.plain(_CHESS, file, stages.chess_color, _HDRI),
        same_in_cycles=True,
    ),
    # of faces that coincide, Cycles shows another one: a strip of the kitchen
    Scene(
        "dream-apartment", (320, 180), _APARTMENT, lambda f: stages.plain(_APARTMENT, f, stages.diffuse_color, _HDRI)
    ),
    Scene("instances", (240, 135), None, stages.instances, reference_samples=192, same_in_cycles=True),
]
