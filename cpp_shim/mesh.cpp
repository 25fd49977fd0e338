#include "mesh.h"

#include "conversions.h"
#include "light.h"
#include "meshPrimvars.h"
#include "renderParam.h"
#include "report.h"

#include "pxr/imaging/hd/changeTracker.h"
#include "pxr/imaging/hd/instancer.h"
#include "pxr/imaging/hd/meshTopology.h"
#include "pxr/imaging/hd/sceneDelegate.h"
#include "pxr/imaging/hd/tokens.h"

#include <algorithm>

PXR_NAMESPACE_OPEN_SCOPE

HdUmberMesh::HdUmberMesh(SdfPath const &id, rust::Box<umber::Mesh> mesh)
    : HdMesh(id)
    , _mesh(std::move(mesh))
{
}

HdDirtyBits HdUmberMesh::GetInitialDirtyBitsMask() const
{
    return HdChangeTracker::InitRepr | HdChangeTracker::DirtyPoints |
           HdChangeTracker::DirtyTopology | HdChangeTracker::DirtyTransform |
           HdChangeTracker::DirtyVisibility | HdChangeTracker::DirtyCullStyle |
           HdChangeTracker::DirtyDoubleSided | HdChangeTracker::DirtyDisplayStyle |
           HdChangeTracker::DirtySubdivTags | HdChangeTracker::DirtyPrimvar |
           HdChangeTracker::DirtyNormals | HdChangeTracker::DirtyMaterialId |
           HdChangeTracker::DirtyPrimID | HdChangeTracker::DirtyInstancer |
           HdChangeTracker::DirtyInstanceIndex | HdChangeTracker::DirtyRenderTag |
           HdChangeTracker::DirtyCategories;
}

void HdUmberMesh::Sync(HdSceneDelegate *delegate, HdRenderParam *param, HdDirtyBits *dirtyBits,
                       TfToken const &)
{
    SdfPath const &id = GetId();
    HdUmberForward(id, [&] {
        if (HdChangeTracker::IsTopologyDirty(*dirtyBits, id)) {
            _SyncTopology(delegate);
        }
        HdUmberSyncMeshPrimvars(id, delegate, *dirtyBits, &*_mesh);
        if (HdChangeTracker::IsTransformDirty(*dirtyBits, id)) {
            _mesh->set_transform(HdUmberMatrix(delegate->GetTransform(id)));
        }
        if (HdChangeTracker::IsVisibilityDirty(*dirtyBits, id)) {
            _UpdateVisibility(delegate, dirtyBits);
            _mesh->set_visible(IsVisible());
        }
        _SyncBinding(delegate, *dirtyBits);
        _SyncInstancing(delegate, dirtyBits);
        _mesh->commit();
        _SyncLight(delegate, param);
    });
    *dirtyBits &= ~HdChangeTracker::AllSceneDirtyBits;
}

void HdUmberMesh::_SyncTopology(HdSceneDelegate *delegate)
{
    HdMeshTopology const topology = GetMeshTopology(delegate);
    _mesh->set_topology(HdUmberText(topology.GetScheme()), HdUmberText(topology.GetOrientation()),
                        HdUmberSlice(topology.GetFaceVertexCounts()),
                        HdUmberSlice(topology.GetFaceVertexIndices()),
                        HdUmberSlice(topology.GetHoleIndices()));
    _mesh->clear_subsets();
    for (HdGeomSubset const &subset : topology.GetGeomSubsets()) {
        if (subset.type == HdGeomSubset::TypeFaceSet) {
            _mesh->add_subset(HdUmberText(subset.materialId), HdUmberSlice(subset.indices));
        }
    }
}

void HdUmberMesh::_SyncBinding(HdSceneDelegate *delegate, HdDirtyBits dirtyBits)
{
    SdfPath const &id = GetId();
    if (HdChangeTracker::IsDoubleSidedDirty(dirtyBits, id)) {
        _mesh->set_double_sided(IsDoubleSided(delegate));
    }
    if (HdChangeTracker::IsCullStyleDirty(dirtyBits, id)) {
        _mesh->set_cull_style(HdUmberCullStyle(GetCullStyle(delegate)));
    }
    if (dirtyBits & HdChangeTracker::DirtyMaterialId) {
        SetMaterialId(delegate->GetMaterialId(id));
        _mesh->set_material(HdUmberText(GetMaterialId()));
    }
    if (HdChangeTracker::IsPrimIdDirty(dirtyBits, id)) {
        _mesh->set_prim_id(GetPrimId());
    }
    if (dirtyBits & HdChangeTracker::DirtyCategories) {
        VtTokenArray const categories = delegate->GetCategories(id);
        _mesh->set_categories(HdUmberSlice(HdUmberTexts(categories)));
    }
}

/// The render index syncs no instancers itself: whoever is instanced asks for it.
void HdUmberMesh::_SyncInstancing(HdSceneDelegate *delegate, HdDirtyBits *dirtyBits)
{
    SdfPath const &id = GetId();
    _UpdateInstancer(delegate, dirtyBits);
    HdInstancer::_SyncInstancerAndParents(delegate->GetRenderIndex(), GetInstancerId());
    if (HdChangeTracker::IsInstancerDirty(*dirtyBits, id) ||
        HdChangeTracker::IsInstanceIndexDirty(*dirtyBits, id)) {
        SdfPath const &instancer = GetInstancerId();
        VtIntArray const indices =
            instancer.IsEmpty() ? VtIntArray() : delegate->GetInstanceIndices(instancer, id);
        _mesh->set_instancer(HdUmberText(instancer), HdUmberSlice(indices));
    }
}

/// UsdLuxMeshLightAPI: the mesh is its own light. No dirty bit of meshes speaks of that: it is asked at each sync.
void HdUmberMesh::_SyncLight(HdSceneDelegate *delegate, HdRenderParam *param)
{
    SdfPath const &id = GetId();
    if (!delegate->GetLightParamValue(id, HdTokens->isLight).GetWithDefault(false)) {
        if (_light) {
            (*_light)->remove();
            _light.reset();
        }
        return;
    }
    auto *const umberParam = static_cast<HdUmberRenderParam *>(param);
    if (!_light) {
        umber::Delegate const &umber = umberParam->GetDelegate();
        _light.emplace(umber::new_light(umber, HdUmberText(id), umber::LightType::Mesh));
    }
    bool const wasLinked = _lightLinked;
    _lightLinked = HdUmberSyncLightParameters(id, delegate, &**_light);
    if (_lightLinked || wasLinked) {
        umberParam->NoteMembers();
    }
    (*_light)->commit();
}

/// Hydra does not sync prims that no pass shows, so that a new tag is passed on at once.
void HdUmberMesh::UpdateRenderTag(HdSceneDelegate *delegate, HdRenderParam *param)
{
    HdMesh::UpdateRenderTag(delegate, param);
    HdUmberForward(GetId(), [&] { _mesh->set_render_tag(HdUmberText(GetRenderTag())); });
}

/// Hydra wants a representation for each name it asks for; there are no draw items to put in.
void HdUmberMesh::_InitRepr(TfToken const &reprToken, HdDirtyBits *)
{
    auto const known = std::find_if(_reprs.begin(), _reprs.end(), _ReprComparator(reprToken));
    if (known == _reprs.end()) {
        _reprs.emplace_back(reprToken, std::make_shared<HdRepr>());
    }
}

void HdUmberMesh::Finalize(HdRenderParam *param)
{
    HdUmberForward(GetId(), [&] {
        if (_light) {
            (*_light)->remove();
        }
        _mesh->remove();
    });
    HdMesh::Finalize(param);
}

PXR_NAMESPACE_CLOSE_SCOPE
