#ifndef UMBER_CPP_SHIM_MATERIAL_H
#define UMBER_CPP_SHIM_MATERIAL_H

#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/imaging/hd/material.h"

PXR_NAMESPACE_OPEN_SCOPE

/// A material: the node behind the surface terminal, its values and what is connected to it.
class HdUmberMaterial final : public HdMaterial
{
public:
    HdUmberMaterial(SdfPath const &id, rust::Box<umber::Material> material);

    HdDirtyBits GetInitialDirtyBitsMask() const override { return AllDirty; }
    void Sync(HdSceneDelegate *delegate, HdRenderParam *param, HdDirtyBits *dirtyBits) override;
    void Finalize(HdRenderParam *param) override;

private:
    void _SyncSurface(HdMaterialNetwork2 const &network);

    rust::Box<umber::Material> _material;
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
