#include "light.h"

#include "conversions.h"
#include "renderParam.h"
#include "report.h"

#include "pxr/imaging/hd/sceneDelegate.h"
#include "pxr/imaging/hd/tokens.h"

PXR_NAMESPACE_OPEN_SCOPE

HdUmberLight::HdUmberLight(SdfPath const &id, rust::Box<umber::Light> light)
    : HdLight(id)
    , _light(std::move(light))
{
}

void HdUmberLight::Sync(HdSceneDelegate *delegate, HdRenderParam *param, HdDirtyBits *dirtyBits)
{
    if (*dirtyBits == Clean) {
        return;
    }
    HdUmberForward(GetId(), [&] {
        if (*dirtyBits & DirtyTransform) {
            _light->set_transform(HdUmberMatrix(delegate->GetTransform(GetId())));
        }
        if (*dirtyBits & ~DirtyTransform) {
            _light->set_visible(delegate->GetVisible(GetId()));
            bool const wasLinked = _linked;
            _linked = HdUmberSyncLightParameters(GetId(), delegate, &*_light);
            if ((*dirtyBits & DirtyCollection) && (_linked || wasLinked)) {
                static_cast<HdUmberRenderParam *>(param)->NoteMembers();
            }
        }
        _light->commit();
    });
    *dirtyBits = Clean;
}

bool HdUmberSyncLightParameters(SdfPath const &id, HdSceneDelegate *delegate, umber::Light *light)
{
    light->reset_parameters();
    for (rust::String const &name : umber::light_parameters()) {
        TfToken const parameter{std::string(name)};
        VtValue const value = delegate->GetLightParamValue(id, parameter);
        HdUmberNumbers const numbers = HdUmberReadNumbers(value);
        if (value.IsHolding<SdfPathVector>()) {
            light->set_paths(name, HdUmberSlice(HdUmberTexts(value.UncheckedGet<SdfPathVector>())));
        } else if (numbers.components > 0) {
            light->set_numbers(name, numbers.Slice());
        } else if (!value.IsEmpty()) {
            light->set_text(name, HdUmberReadText(value));
        }
    }
    // A DomeLight_1's poleAxis comes as a matrix.
    VtValue const offset = delegate->GetLightParamValue(id, HdLightTokens->domeOffset);
    if (offset.IsHolding<GfMatrix4d>()) {
        light->set_dome_offset(HdUmberMatrix(offset.UncheckedGet<GfMatrix4d>()));
    }
    auto const isLinked = [&](TfToken const &link) {
        return !delegate->GetLightParamValue(id, link).GetWithDefault(TfToken()).IsEmpty();
    };
    return isLinked(HdTokens->lightLink) || isLinked(HdTokens->shadowLink);
}

void HdUmberLight::Finalize(HdRenderParam *param)
{
    HdUmberForward(GetId(), [&] { _light->remove(); });
    HdLight::Finalize(param);
}

PXR_NAMESPACE_CLOSE_SCOPE
