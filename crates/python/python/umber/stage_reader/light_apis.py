"""ShapingAPI and ShadowAPI of lights."""

from __future__ import annotations

from pxr import Usd

from umber.description import Light
from umber.stage_reader.reading import Reading, asset_file, single

# Inputs and the fields that take them.
SHAPING = {
    "shaping:focus": "focus",
    "shaping:focusTint": "focus_tint",
    "shaping:cone:angle": "cone_angle_deg",
    "shaping:cone:softness": "cone_softness",
    "shaping:ies:file": "ies_file",
    "shaping:ies:angleScale": "ies_angle_scale",
    "shaping:ies:normalize": "ies_normalize",
}
SHADOW = {
    "shadow:color": "color",
    "shadow:distance": "distance",
    "shadow:falloff": "falloff",
    "shadow:falloffGamma": "falloff_gamma",
}


def read_light_apis(reading: Reading, prim: Usd.Prim, light: Light) -> None:
    """Takes what there is; where a schema is applied that is its fallbacks as well."""
    _read(reading, prim, light.shaping, SHAPING)
    _read(reading, prim, light.shadow, SHADOW)


def _read(reading: Reading, prim: Usd.Prim, to: object, fields: dict[str, str]) -> None:
    for name, field in fields.items():
        value = reading.value(prim, f"inputs:{name}")
        if value is None:
            continue
        if name == "shaping:ies:file":
            value = asset_file(value)
        elif isinstance(value, bool):
            pass
        elif isinstance(value, int | float):
            value = single(value)
        else:
            value = tuple(value)
        setattr(to, field, value)
