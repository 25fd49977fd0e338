#ifndef UMBER_CPP_SHIM_RENDERER_PLUGIN_H
#define UMBER_CPP_SHIM_RENDERER_PLUGIN_H

#include "pxr/pxr.h"
#include "pxr/imaging/hd/rendererPlugin.h"

PXR_NAMESPACE_OPEN_SCOPE

/// What plugInfo.json names: makes delegates, as many as a host wants.
class HdUmberRendererPlugin final : public HdRendererPlugin
{
public:
    HdRenderDelegate *CreateRenderDelegate() override;
    HdRenderDelegate *CreateRenderDelegate(HdRenderSettingsMap const &settingsMap) override;
    void DeleteRenderDelegate(HdRenderDelegate *renderDelegate) override;

    /// Always: Umber needs no device.
#if PXR_VERSION >= 2511
    bool IsSupported(HdRendererCreateArgs const &args, std::string *reasonWhyNot) const override;
#else
    bool IsSupported(bool gpuEnabled) const override;
#endif
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
