#ifndef UMBER_CPP_SHIM_LIGHT_H
#define UMBER_CPP_SHIM_LIGHT_H

#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/imaging/hd/light.h"

PXR_NAMESPACE_OPEN_SCOPE

/// Pulls all parameters of the prim's light that the Rust half reads; whether a link of it leaves anything out.
bool HdUmberSyncLightParameters(SdfPath const &id, HdSceneDelegate *delegate, umber::Light *light);

/// A light of any shape: the shape is known to the Rust half.
class HdUmberLight final : public HdLight
{
public:
    HdUmberLight(SdfPath const &id, rust::Box<umber::Light> light);

    HdDirtyBits GetInitialDirtyBitsMask() const override { return AllDirty; }
    void Sync(HdSceneDelegate *delegate, HdRenderParam *param, HdDirtyBits *dirtyBits) override;
    void Finalize(HdRenderParam *param) override;

private:
    rust::Box<umber::Light> _light;
    /// Whether a link of it leaves anything out.
    bool _linked = false;
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
