"""From descriptions to a session."""

from __future__ import annotations

from collections.abc import Iterable

from umber._umber import Session
from umber.description import Instancer, Light, Material, Mesh, Prim


def feed(session: Session, prims: Iterable[Prim]) -> int:
    """Sends descriptions to a session; gives the number of meshes among them."""
    meshes = 0
    for prim in prims:
        match prim:
            case Mesh():
                session.mesh(prim)
                meshes += 1
            case Instancer():
                session.instancer(prim)
            case Light():
                session.light(prim)
            case Material():
                session.material(prim)
    return meshes
