"""What a scene consists of, as plain data: what the stage reader gives and a session takes.

Words (purpose, interpolation, scheme, orientation) are the tokens of the USD schemas.
Transforms are float64 of shape (4, 4) in USD's layout: row vectors, translation in the last row.
Points, normals and primvars are in object space. Fallbacks are those of the USD schemas.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]
Ints = npt.NDArray[np.int32]
Doubles = npt.NDArray[np.float64]
Color = tuple[float, float, float]

NO_INTS: Ints = np.empty(0, np.int32)
IDENTITY: Doubles = np.eye(4)


@dataclass(slots=True)
class Primvar:
    """Values, shape (n,) or (n, 2 to 4), already expanded from indices, and how they spread."""

    values: Floats
    interpolation: str


@dataclass(slots=True)
class Subset:
    """Faces, shape (n,), with a material of their own; None takes the mesh's."""

    material: str | None
    faces: Ints


@dataclass(slots=True)
class Mesh:
    """A mesh. Its transform leads to the innermost instancer's space, or to the world."""

    path: str
    points: Floats
    face_vertex_counts: Ints
    face_vertex_indices: Ints
    hole_indices: Ints = field(default_factory=lambda: NO_INTS)
    subdivision_scheme: str = "none"
    orientation: str = "rightHanded"
    normals: Primvar | None = None
    primvars: dict[str, Primvar] = field(default_factory=dict)
    subsets: list[Subset] = field(default_factory=list)
    transform: Doubles = field(default_factory=lambda: IDENTITY)
    purpose: str = "default"
    double_sided: bool = False
    material: str | None = None
    instancer: str | None = None
    instance_indices: Ints = field(default_factory=lambda: NO_INTS)
    prim_id: int = -1
    categories: list[str] = field(default_factory=list)
    """What of it light and shadow links may name; of an instanced mesh, the outermost instancer says it."""


@dataclass(slots=True)
class Instancer:
    """Where instances stand: transforms, shape (n, 4, 4), lead to the parent's space or the world.

    `categories` as of a mesh, a list an instance; a single one counts for all instances.
    """

    path: str
    transforms: Doubles
    parent: str | None = None
    parent_indices: Ints = field(default_factory=lambda: NO_INTS)
    categories: list[list[str]] = field(default_factory=list)


@dataclass(slots=True)
class Camera:
    """A camera that looks along -Z with +Y up. Apertures, offsets and focal length share a unit.

    `conform_policy`: matchVertically, matchHorizontally, fit, crop or dontConform.
    """

    path: str
    transform: Doubles
    aperture: tuple[float, float]
    focal_length: float
    aperture_offset: tuple[float, float] = (0.0, 0.0)
    orthographic: bool = False
    clipping_range: tuple[float, float] = (1.0, 1_000_000.0)
    conform_policy: str = "matchVertically"


@dataclass(slots=True)
class Shaping:
    """ShapingAPI: what a light's emission is multiplied by, by direction. This is a light without it."""

    focus: float = 0.0
    focus_tint: Color = (0.0, 0.0, 0.0)
    cone_angle_deg: float = 180.0
    cone_softness: float = 0.0
    ies_file: str | None = None
    ies_angle_scale: float = 0.0
    ies_normalize: bool = False


@dataclass(slots=True)
class Shadow:
    """ShadowAPI, but for its switch. A negative distance is no limit."""

    color: Color = (0.0, 0.0, 0.0)
    distance: float = -1.0
    falloff: float = -1.0
    falloff_gamma: float = 1.0


@dataclass(slots=True)
class Light:
    """A light of UsdLux: distant, dome, rect, sphere, disk, cylinder, portal or mesh.

    What its kind does not have is ignored. `portals`: paths of the portals of a dome. `mesh`: path of the mesh that a
    mesh light shines from, wherever that stands. Links name the category of what the light illuminates, and of what
    casts shadows in it; None is everything.
    """

    path: str
    kind: str
    transform: Doubles = field(default_factory=lambda: IDENTITY)
    angle_deg: float = 0.53
    width: float = 1.0
    height: float = 1.0
    radius: float = 0.5
    length: float = 1.0
    treat_as_point: bool = False
    treat_as_line: bool = False
    texture_file: str | None = None
    texture_format: str = "automatic"
    mesh: str | None = None
    material_sync_mode: str = "materialGlowTintsLight"
    color: Color = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    exposure: float = 0.0
    normalize: bool = False
    color_temperature: float | None = None
    diffuse: float = 1.0
    specular: float = 1.0
    shadow_enable: bool = True
    shaping: Shaping = field(default_factory=Shaping)
    shadow: Shadow = field(default_factory=Shadow)
    portals: list[str] = field(default_factory=list)
    light_link: str | None = None
    shadow_link: str | None = None


@dataclass(slots=True)
class PreviewSurface:
    """UsdPreviewSurface with constant inputs."""

    diffuse_color: Color = (0.18, 0.18, 0.18)
    emissive_color: Color = (0.0, 0.0, 0.0)
    use_specular_workflow: bool = False
    specular_color: Color = (0.0, 0.0, 0.0)
    metallic: float = 0.0
    roughness: float = 0.5
    clearcoat: float = 0.0
    clearcoat_roughness: float = 0.01
    opacity: float = 1.0
    opacity_mode: str = "transparent"
    opacity_threshold: float = 0.0
    ior: float = 1.5


@dataclass(slots=True)
class Material:
    """A material; without a surface that Umber understands, meshes show their displayColor."""

    path: str
    surface: PreviewSurface | None = None


Prim = Mesh | Instancer | Light | Material
