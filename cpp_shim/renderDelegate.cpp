#include "renderDelegate.h"

#include "camera.h"
#include "conversions.h"
#include "instancer.h"
#include "light.h"
#include "material.h"
#include "mesh.h"
#include "renderBuffer.h"
#include "renderPass.h"

#include "pxr/base/tf/diagnostic.h"
#include "pxr/imaging/hd/extComputation.h"
#include "pxr/imaging/hd/resourceRegistry.h"
#include "pxr/imaging/hd/tokens.h"

PXR_NAMESPACE_OPEN_SCOPE

HdUmberRenderDelegate::HdUmberRenderDelegate(rust::Box<umber::Delegate> delegate,
                                             HdRenderSettingsMap const &settingsMap)
    : HdRenderDelegate(settingsMap)
    , _delegate(std::move(delegate))
    , _renderParam(*_delegate)
    , _resourceRegistry(std::make_shared<HdResourceRegistry>())
{
    HdUmberForward(SdfPath(), [&] {
        for (umber::NamedValue const &row : umber::setting_rows()) {
            _settingDescriptors.push_back({std::string(row.label), TfToken(std::string(row.name)),
                                           HdUmberSettingValue(row.value)});
        }
        _aovs = umber::aov_rows();
    });
    _PopulateDefaultSettings(_settingDescriptors);
    for (auto const &setting : settingsMap) {
        SetRenderSetting(setting.first, setting.second);
    }
}

HdUmberRenderDelegate::~HdUmberRenderDelegate()
{
    HdUmberPostReports(*_delegate);
}

HdRenderParam *HdUmberRenderDelegate::GetRenderParam() const
{
    return const_cast<HdUmberRenderParam *>(&_renderParam);
}

HdResourceRegistrySharedPtr HdUmberRenderDelegate::GetResourceRegistry() const
{
    return _resourceRegistry;
}

void HdUmberRenderDelegate::CommitResources(HdChangeTracker *)
{
    if (_renderParam.TakeMembers()) {
        for (HdUmberInstancer *instancer : _instancers) {
            instancer->UpdateCategories();
        }
    }
}

// ---- settings, figures, AOVs ----

void HdUmberRenderDelegate::SetRenderSetting(TfToken const &key, VtValue const &value)
{
    HdRenderDelegate::SetRenderSetting(key, value);
    umber::Value plain;
    if (HdUmberReadValue(value, &plain)) {
        HdUmberForward(SdfPath(), [&] { _delegate->set_setting(HdUmberText(key), plain); });
    }
}

HdRenderSettingDescriptorList HdUmberRenderDelegate::GetRenderSettingDescriptors() const
{
    return _settingDescriptors;
}

VtDictionary HdUmberRenderDelegate::GetRenderStats() const
{
    HdUmberPostReports(*_delegate);
    VtDictionary stats;
    HdUmberForward(SdfPath(), [&] {
        for (umber::NamedValue const &row : _delegate->stats()) {
            stats[std::string(row.name)] = HdUmberStatValue(row.value);
        }
    });
    return stats;
}

HdAovDescriptor HdUmberRenderDelegate::GetDefaultAovDescriptor(TfToken const &name) const
{
    for (umber::AovDescription const &aov : _aovs) {
        if (name != std::string(aov.name)) {
            continue;
        }
        HdFormat const format = HdUmberHdFormat(aov.format);
        VtValue clear;
        switch (format) {
            case HdFormatInt32: clear = int(aov.clear); break;
            case HdFormatFloat32Vec2: clear = GfVec2f(aov.clear); break;
            case HdFormatFloat32Vec3: clear = GfVec3f(aov.clear); break;
            case HdFormatFloat32Vec4: clear = GfVec4f(aov.clear); break;
            default: clear = aov.clear; break;
        }
        return HdAovDescriptor(format, /*multiSampled=*/false, clear);
    }
    return HdAovDescriptor();
}

// ---- pausing and stopping ----

bool HdUmberRenderDelegate::IsPauseSupported() const { return true; }

bool HdUmberRenderDelegate::IsPaused() const
{
    bool paused = false;
    HdUmberForward(SdfPath(), [&] { paused = _delegate->is_paused(); });
    return paused;
}

bool HdUmberRenderDelegate::Pause()
{
    return HdUmberForward(SdfPath(), [&] { _delegate->set_paused(true); });
}

bool HdUmberRenderDelegate::Resume()
{
    return HdUmberForward(SdfPath(), [&] { _delegate->set_paused(false); });
}

bool HdUmberRenderDelegate::IsStopSupported() const { return true; }

bool HdUmberRenderDelegate::IsStopped() const
{
    bool stopped = true;
    HdUmberForward(SdfPath(), [&] { stopped = _delegate->is_stopped(); });
    return stopped;
}

bool HdUmberRenderDelegate::Stop(bool)
{
    return HdUmberForward(SdfPath(), [&] { _delegate->stop(); });
}

bool HdUmberRenderDelegate::Restart()
{
    return HdUmberForward(SdfPath(), [&] { _delegate->restart(); });
}

// ---- prims ----

TfTokenVector const &HdUmberRenderDelegate::GetSupportedRprimTypes() const
{
    static TfTokenVector const types{HdPrimTypeTokens->mesh};
    return types;
}

TfTokenVector const &HdUmberRenderDelegate::GetSupportedSprimTypes() const
{
    static TfTokenVector const types{
        HdPrimTypeTokens->extComputation, HdPrimTypeTokens->material,
        HdPrimTypeTokens->camera,         HdPrimTypeTokens->distantLight,
        HdPrimTypeTokens->domeLight,      HdPrimTypeTokens->rectLight,
        HdPrimTypeTokens->sphereLight,    HdPrimTypeTokens->diskLight,
        HdPrimTypeTokens->cylinderLight,    HdPrimTypeTokens->light,
    };
    return types;
}

TfTokenVector const &HdUmberRenderDelegate::GetSupportedBprimTypes() const
{
    static TfTokenVector const types{HdPrimTypeTokens->renderBuffer};
    return types;
}

HdRenderPassSharedPtr
HdUmberRenderDelegate::CreateRenderPass(HdRenderIndex *index, HdRprimCollection const &collection)
{
    return std::make_shared<HdUmberRenderPass>(index, collection, *_delegate);
}

HdInstancer *HdUmberRenderDelegate::CreateInstancer(HdSceneDelegate *delegate, SdfPath const &id)
{
    HdUmberInstancer *instancer = nullptr;
    HdUmberForward(id, [&] {
        instancer =
            new HdUmberInstancer(delegate, id, umber::new_instancer(*_delegate, HdUmberText(id)));
        _instancers.insert(instancer);
    });
    return instancer;
}

HdRprim *HdUmberRenderDelegate::CreateRprim(TfToken const &typeId, SdfPath const &id)
{
    HdRprim *rprim = nullptr;
    if (typeId == HdPrimTypeTokens->mesh) {
        HdUmberForward(id, [&] {
            rprim = new HdUmberMesh(id, umber::new_mesh(*_delegate, HdUmberText(id)));
        });
    } else {
        TF_CODING_ERROR("Umber has no Rprim type %s", typeId.GetText());
    }
    return rprim;
}

HdSprim *HdUmberRenderDelegate::CreateSprim(TfToken const &typeId, SdfPath const &id)
{
    HdSprim *sprim = nullptr;
    HdUmberForward(id, [&] {
        rust::Str const path = HdUmberText(id);
        auto const light = [&](umber::LightType type) {
            return new HdUmberLight(id, umber::new_light(*_delegate, path, type));
        };
        if (typeId == HdPrimTypeTokens->camera) {
            sprim = new HdUmberCamera(id, umber::new_camera(*_delegate, path));
        } else if (typeId == HdPrimTypeTokens->material) {
            sprim = new HdUmberMaterial(id, umber::new_material(*_delegate, path));
        } else if (typeId == HdPrimTypeTokens->extComputation) {
            sprim = new HdExtComputation(id);
        } else if (typeId == HdPrimTypeTokens->distantLight) {
            sprim = light(umber::LightType::Distant);
        } else if (typeId == HdPrimTypeTokens->domeLight) {
            sprim = light(umber::LightType::Dome);
        } else if (typeId == HdPrimTypeTokens->rectLight) {
            sprim = light(umber::LightType::Rect);
        } else if (typeId == HdPrimTypeTokens->sphereLight) {
            sprim = light(umber::LightType::Sphere);
        } else if (typeId == HdPrimTypeTokens->diskLight) {
            sprim = light(umber::LightType::Disk);
        } else if (typeId == HdPrimTypeTokens->cylinderLight) {
            sprim = light(umber::LightType::Cylinder);
        } else if (typeId == HdPrimTypeTokens->light) {
            sprim = light(umber::LightType::Other);
        } else {
            TF_CODING_ERROR("Umber has no Sprim type %s", typeId.GetText());
        }
    });
    return sprim;
}

HdSprim *HdUmberRenderDelegate::CreateFallbackSprim(TfToken const &typeId)
{
    return CreateSprim(typeId, SdfPath());
}

HdBprim *HdUmberRenderDelegate::CreateBprim(TfToken const &typeId, SdfPath const &id)
{
    HdBprim *bprim = nullptr;
    if (typeId == HdPrimTypeTokens->renderBuffer) {
        HdUmberForward(id, [&] {
            bprim = new HdUmberRenderBuffer(id,
                                            umber::new_render_buffer(*_delegate, HdUmberText(id)));
        });
    } else {
        TF_CODING_ERROR("Umber has no Bprim type %s", typeId.GetText());
    }
    return bprim;
}

HdBprim *HdUmberRenderDelegate::CreateFallbackBprim(TfToken const &typeId)
{
    return CreateBprim(typeId, SdfPath());
}

void HdUmberRenderDelegate::DestroyInstancer(HdInstancer *instancer)
{
    _instancers.erase(static_cast<HdUmberInstancer *>(instancer));
    delete instancer;
}
void HdUmberRenderDelegate::DestroyRprim(HdRprim *rprim) { delete rprim; }
void HdUmberRenderDelegate::DestroySprim(HdSprim *sprim) { delete sprim; }
void HdUmberRenderDelegate::DestroyBprim(HdBprim *bprim) { delete bprim; }

bool HdUmberRenderDelegate::IsParallelSyncEnabled(TfToken const &) const { return true; }

// ---- materials ----

TfToken HdUmberRenderDelegate::GetMaterialBindingPurpose() const { return HdTokens->full; }

/// The universal context alone.
TfTokenVector HdUmberRenderDelegate::GetMaterialRenderContexts() const { return {TfToken()}; }

/// How OpenUSD's shader registry files UsdPreviewSurface and its companions.
TfTokenVector HdUmberRenderDelegate::GetShaderSourceTypes() const { return {TfToken("glslfx")}; }

PXR_NAMESPACE_CLOSE_SCOPE
