#ifndef UMBER_CPP_SHIM_MESH_H
#define UMBER_CPP_SHIM_MESH_H

#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/imaging/hd/mesh.h"

#include <optional>

PXR_NAMESPACE_OPEN_SCOPE

/// A mesh.
class HdUmberMesh final : public HdMesh
{
public:
    HdUmberMesh(SdfPath const &id, rust::Box<umber::Mesh> mesh);

    HdDirtyBits GetInitialDirtyBitsMask() const override;
    void Sync(HdSceneDelegate *delegate, HdRenderParam *param, HdDirtyBits *dirtyBits,
              TfToken const &reprToken) override;
    void UpdateRenderTag(HdSceneDelegate *delegate, HdRenderParam *param) override;
    void Finalize(HdRenderParam *param) override;

protected:
    HdDirtyBits _PropagateDirtyBits(HdDirtyBits bits) const override { return bits; }
    void _InitRepr(TfToken const &reprToken, HdDirtyBits *dirtyBits) override;

private:
    void _SyncTopology(HdSceneDelegate *delegate);
    void _SyncBinding(HdSceneDelegate *delegate, HdDirtyBits dirtyBits);
    void _SyncInstancing(HdSceneDelegate *delegate, HdDirtyBits *dirtyBits);
    void _SyncLight(HdSceneDelegate *delegate, HdRenderParam *param);

    rust::Box<umber::Mesh> _mesh;
    std::optional<rust::Box<umber::Light>> _light;
    /// Whether a link of the light leaves anything out.
    bool _lightLinked = false;
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
