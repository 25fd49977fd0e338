#include "light.h"

#include "conversions.h"
#include "report.h"

#include "pxr/imaging/hd/sceneDelegate.h"

PXR_NAMESPACE_OPEN_SCOPE

HdUmberLight::HdUmberLight(SdfPath const &id, rust::Box<umber::Light> light)
    : HdLight(id)
    , _light(std::move(light))
{
}

void HdUmberLight::Sync(HdSceneDelegate *delegate, HdRenderParam *, HdDirtyBits *dirtyBits)
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
            HdUmberSyncLightParameters(GetId(), delegate, &*_light);
        }
        _light->commit();
    });
    *dirtyBits = Clean;
}

void HdUmberSyncLightParameters(SdfPath const &id, HdSceneDelegate *delegate, umber::Light *light)
{
    light->reset_parameters();
    for (rust::String const &name : umber::light_parameters()) {
        TfToken const parameter{std::string(name)};
        VtValue const value = delegate->GetLightParamValue(id, parameter);
        HdUmberNumbers const numbers = HdUmberReadNumbers(value);
        if (numbers.components > 0) {
            light->set_numbers(name, numbers.Slice());
        } else if (!value.IsEmpty()) {
            light->set_text(name, HdUmberReadText(value));
        }
    }
}

void HdUmberLight::Finalize(HdRenderParam *param)
{
    HdUmberForward(GetId(), [&] { _light->remove(); });
    HdLight::Finalize(param);
}

PXR_NAMESPACE_CLOSE_SCOPE
