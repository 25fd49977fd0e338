#ifndef UMBER_CPP_SHIM_MESH_PRIMVARS_H
#define UMBER_CPP_SHIM_MESH_PRIMVARS_H

#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/imaging/hd/sceneDelegate.h"

PXR_NAMESPACE_OPEN_SCOPE

/// Pulls points and primvars that are dirty, authored and computed alike.
void HdUmberSyncMeshPrimvars(SdfPath const &id, HdSceneDelegate *delegate, HdDirtyBits dirtyBits,
                             umber::Mesh *mesh);

PXR_NAMESPACE_CLOSE_SCOPE

#endif
