#include "meshPrimvars.h"

#include "conversions.h"

#include "pxr/imaging/hd/changeTracker.h"
#include "pxr/imaging/hd/extComputationUtils.h"
#include "pxr/imaging/hd/tokens.h"

#include <algorithm>
#include <map>

PXR_NAMESPACE_OPEN_SCOPE

namespace {

struct _Primvar
{
    VtValue value;
    HdInterpolation interpolation;
};
using _PrimvarMap = std::map<TfToken, _Primvar>;

/// Wanted names that are dirty: points, and what the Rust half reads.
TfTokenVector _DirtyNames(SdfPath const &id, HdDirtyBits dirtyBits)
{
    TfTokenVector names{HdTokens->points};
    for (rust::String const &name : umber::mesh_primvars()) {
        names.emplace_back(std::string(name));
    }
    names.erase(std::remove_if(names.begin(), names.end(),
                               [&](TfToken const &name) {
                                   return !HdChangeTracker::IsPrimvarDirty(dirtyBits, id, name);
                               }),
                names.end());
    return names;
}

bool _Contains(TfTokenVector const &names, TfToken const &name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// A computed primvar takes the place of an authored one of the same name.
_PrimvarMap _Pull(SdfPath const &id, HdSceneDelegate *delegate, TfTokenVector const &names)
{
    _PrimvarMap primvars;
    HdExtComputationPrimvarDescriptorVector computed;
    for (int i = 0; i < HdInterpolationCount; ++i) {
        HdInterpolation const interpolation = HdInterpolation(i);
        for (auto const &primvar : delegate->GetPrimvarDescriptors(id, interpolation)) {
            if (_Contains(names, primvar.name)) {
                primvars[primvar.name] = {delegate->Get(id, primvar.name), interpolation};
            }
        }
        for (auto const &primvar : delegate->GetExtComputationPrimvarDescriptors(id, interpolation)) {
            if (_Contains(names, primvar.name)) {
                computed.push_back(primvar);
            }
        }
    }
    if (!computed.empty()) {
        auto const values = HdExtComputationUtils::GetComputedPrimvarValues(computed, delegate);
        for (auto const &primvar : computed) {
            auto const value = values.find(primvar.name);
            if (value != values.end()) {
                primvars[primvar.name] = {value->second, primvar.interpolation};
            }
        }
    }
    return primvars;
}

} // namespace

void HdUmberSyncMeshPrimvars(SdfPath const &id, HdSceneDelegate *delegate, HdDirtyBits dirtyBits,
                             umber::Mesh *mesh)
{
    TfTokenVector const names = _DirtyNames(id, dirtyBits);
    if (names.empty()) {
        return;
    }
    _PrimvarMap const primvars = _Pull(id, delegate, names);
    for (TfToken const &name : names) {
        auto const found = primvars.find(name);
        HdUmberNumbers const numbers =
            found == primvars.end() ? HdUmberNumbers() : HdUmberReadNumbers(found->second.value);
        if (name == HdTokens->points) {
            mesh->set_points(numbers.Slice());
        } else if (numbers.components == 0) {
            mesh->clear_primvar(HdUmberText(name));
        } else {
            mesh->set_primvar(HdUmberText(name), HdUmberInterpolation(found->second.interpolation),
                              numbers.components, numbers.Slice());
        }
    }
}

PXR_NAMESPACE_CLOSE_SCOPE
