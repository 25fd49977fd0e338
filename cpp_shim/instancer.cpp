#include "instancer.h"

#include "conversions.h"
#include "instanceTransforms.h"
#include "report.h"

#include "pxr/imaging/hd/changeTracker.h"

PXR_NAMESPACE_OPEN_SCOPE

static_assert(sizeof(GfMatrix4d) == 16 * sizeof(double), "matrices follow each other without gaps");

HdUmberInstancer::HdUmberInstancer(HdSceneDelegate *delegate, SdfPath const &id,
                                   rust::Box<umber::Instancer> instancer)
    : HdInstancer(delegate, id)
    , _instancer(std::move(instancer))
{
}

HdDirtyBits HdUmberInstancer::GetInitialDirtyBitsMask() const
{
    return HdInstancer::GetInitialDirtyBitsMask() | HdChangeTracker::DirtyCategories;
}

void HdUmberInstancer::Sync(HdSceneDelegate *delegate, HdRenderParam *, HdDirtyBits *dirtyBits)
{
    SdfPath const &id = GetId();
    _UpdateInstancer(delegate, dirtyBits);
    HdUmberForward(id, [&] {
        if (HdChangeTracker::IsTransformDirty(*dirtyBits, id) ||
            HdChangeTracker::IsAnyPrimvarDirty(*dirtyBits, id)) {
            VtMatrix4dArray const transforms = HdUmberInstanceTransforms(delegate, id);
            auto const *numbers = reinterpret_cast<double const *>(transforms.cdata());
            _instancer->set_transforms({numbers, transforms.size() * 16});
        }
        if (HdChangeTracker::IsInstancerDirty(*dirtyBits, id) ||
            HdChangeTracker::IsInstanceIndexDirty(*dirtyBits, id)) {
            SdfPath const &parent = GetParentId();
            VtIntArray const indices =
                parent.IsEmpty() ? VtIntArray() : delegate->GetInstanceIndices(parent, id);
            _instancer->set_parent(HdUmberText(parent), HdUmberSlice(indices));
        }
        if (HdChangeTracker::IsVisibilityDirty(*dirtyBits, id)) {
            _instancer->set_visible(delegate->GetVisible(id));
        }
        if (*dirtyBits & (HdChangeTracker::DirtyCategories | HdChangeTracker::DirtyInstanceIndex)) {
            _SyncCategories(delegate);
        }
        _instancer->commit();
        _synced = true;
    });
    *dirtyBits &= HdChangeTracker::Varying;
}

void HdUmberInstancer::UpdateCategories()
{
    if (_synced) {
        HdUmberForward(GetId(), [&] {
            _SyncCategories(GetDelegate());
            _instancer->commit();
        });
    }
}

/// Native instances have categories each, point instancers one set for all of theirs.
void HdUmberInstancer::_SyncCategories(HdSceneDelegate *delegate)
{
    _instancer->clear_categories();
    std::vector<VtTokenArray> sets = delegate->GetInstanceCategories(GetId());
    if (sets.empty()) {
        sets.push_back(delegate->GetCategories(GetId()));
    }
    for (VtTokenArray const &set : sets) {
        _instancer->add_categories(HdUmberSlice(HdUmberTexts(set)));
    }
}

void HdUmberInstancer::Finalize(HdRenderParam *param)
{
    HdUmberForward(GetId(), [&] { _instancer->remove(); });
    HdInstancer::Finalize(param);
}

PXR_NAMESPACE_CLOSE_SCOPE
