#ifndef UMBER_CPP_SHIM_RENDER_DELEGATE_H
#define UMBER_CPP_SHIM_RENDER_DELEGATE_H

#include "renderParam.h"
#include "report.h"

#include "pxr/pxr.h"
#include "pxr/imaging/hd/renderDelegate.h"

#include <set>

PXR_NAMESPACE_OPEN_SCOPE

class HdUmberInstancer;

/// Makes the prims, and passes on settings, pauses and figures.
class HdUmberRenderDelegate final : public HdRenderDelegate
{
public:
    HdUmberRenderDelegate(rust::Box<umber::Delegate> delegate,
                          HdRenderSettingsMap const &settingsMap);
    ~HdUmberRenderDelegate() override;

    TfTokenVector const &GetSupportedRprimTypes() const override;
    TfTokenVector const &GetSupportedSprimTypes() const override;
    TfTokenVector const &GetSupportedBprimTypes() const override;
    HdRenderParam *GetRenderParam() const override;
    HdResourceRegistrySharedPtr GetResourceRegistry() const override;

    void SetRenderSetting(TfToken const &key, VtValue const &value) override;
    HdRenderSettingDescriptorList GetRenderSettingDescriptors() const override;
    VtDictionary GetRenderStats() const override;
    HdAovDescriptor GetDefaultAovDescriptor(TfToken const &name) const override;

    bool IsPauseSupported() const override;
    bool IsPaused() const override;
    bool Pause() override;
    bool Resume() override;
    bool IsStopSupported() const override;
    bool IsStopped() const override;
    bool Stop(bool blocking) override;
    bool Restart() override;

    HdRenderPassSharedPtr CreateRenderPass(HdRenderIndex *index,
                                           HdRprimCollection const &collection) override;
    HdInstancer *CreateInstancer(HdSceneDelegate *delegate, SdfPath const &id) override;
    void DestroyInstancer(HdInstancer *instancer) override;
    HdRprim *CreateRprim(TfToken const &typeId, SdfPath const &id) override;
    void DestroyRprim(HdRprim *rprim) override;
    HdSprim *CreateSprim(TfToken const &typeId, SdfPath const &id) override;
    HdSprim *CreateFallbackSprim(TfToken const &typeId) override;
    void DestroySprim(HdSprim *sprim) override;
    HdBprim *CreateBprim(TfToken const &typeId, SdfPath const &id) override;
    HdBprim *CreateFallbackBprim(TfToken const &typeId) override;
    void DestroyBprim(HdBprim *bprim) override;
    void CommitResources(HdChangeTracker *tracker) override;

    TfToken GetMaterialBindingPurpose() const override;
    TfTokenVector GetMaterialRenderContexts() const override;
    TfTokenVector GetShaderSourceTypes() const override;
    bool IsParallelSyncEnabled(TfToken const &primType) const
#if PXR_VERSION >= 2408
        override
#endif
        ;

private:
    rust::Box<umber::Delegate> _delegate;
    HdUmberRenderParam _renderParam;
    HdResourceRegistrySharedPtr _resourceRegistry;
    HdRenderSettingDescriptorList _settingDescriptors;
    rust::Vec<umber::AovDescription> _aovs;
    std::set<HdUmberInstancer *> _instancers;
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
