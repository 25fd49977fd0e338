#ifndef UMBER_CPP_SHIM_INSTANCER_H
#define UMBER_CPP_SHIM_INSTANCER_H

#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/imaging/hd/instancer.h"

PXR_NAMESPACE_OPEN_SCOPE

/// An instancer: one level of it. Nested ones are put together by the renderer.
class HdUmberInstancer final : public HdInstancer
{
public:
    HdUmberInstancer(HdSceneDelegate *delegate, SdfPath const &id,
                     rust::Box<umber::Instancer> instancer);

    HdDirtyBits GetInitialDirtyBitsMask() const override;
    void Sync(HdSceneDelegate *delegate, HdRenderParam *param, HdDirtyBits *dirtyBits) override;
    void Finalize(HdRenderParam *param) override;

    /// Asks for the categories again, which a change of others' collections may have changed.
    void UpdateCategories();

private:
    void _SyncCategories(HdSceneDelegate *delegate);

    rust::Box<umber::Instancer> _instancer;
    bool _synced = false;
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
