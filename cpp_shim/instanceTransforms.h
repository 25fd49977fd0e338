#ifndef UMBER_CPP_SHIM_INSTANCE_TRANSFORMS_H
#define UMBER_CPP_SHIM_INSTANCE_TRANSFORMS_H

#include "pxr/pxr.h"
#include "pxr/base/vt/types.h"
#include "pxr/imaging/hd/sceneDelegate.h"

PXR_NAMESPACE_OPEN_SCOPE

/// One transform an instance of this level: parent space from prototype space, made from the
/// instancer's own transform and its instance primvars (translations, rotations, scales, matrices).
VtMatrix4dArray HdUmberInstanceTransforms(HdSceneDelegate *delegate, SdfPath const &instancerId);

PXR_NAMESPACE_CLOSE_SCOPE

#endif
