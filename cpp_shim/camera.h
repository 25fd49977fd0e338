#ifndef UMBER_CPP_SHIM_CAMERA_H
#define UMBER_CPP_SHIM_CAMERA_H

#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/imaging/hd/camera.h"

PXR_NAMESPACE_OPEN_SCOPE

/// A camera: HdCamera pulls the attributes, this class passes them on.
class HdUmberCamera final : public HdCamera
{
public:
    HdUmberCamera(SdfPath const &id, rust::Box<umber::Camera> camera);

    void Sync(HdSceneDelegate *delegate, HdRenderParam *param, HdDirtyBits *dirtyBits) override;
    void Finalize(HdRenderParam *param) override;

    /// Renders through this camera, its window conformed by the pass' policy.
    void LookThrough(umber::WindowPolicy policy) const;

private:
    /// Mutable: which camera a pass looks through is the scene's state, not the prim's.
    mutable rust::Box<umber::Camera> _camera;
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
