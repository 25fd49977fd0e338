#include "rendererPlugin.h"

#include "renderDelegate.h"

#include "pxr/imaging/hd/rendererPluginRegistry.h"

PXR_NAMESPACE_OPEN_SCOPE

TF_REGISTRY_FUNCTION(TfType)
{
    HdRendererPluginRegistry::Define<HdUmberRendererPlugin>();
}

HdRenderDelegate *HdUmberRendererPlugin::CreateRenderDelegate()
{
    return CreateRenderDelegate(HdRenderSettingsMap());
}

HdRenderDelegate *
HdUmberRendererPlugin::CreateRenderDelegate(HdRenderSettingsMap const &settingsMap)
{
    HdRenderDelegate *delegate = nullptr;
    HdUmberForward(SdfPath(), [&] {
        delegate = new HdUmberRenderDelegate(umber::new_delegate(), settingsMap);
    });
    return delegate;
}

void HdUmberRendererPlugin::DeleteRenderDelegate(HdRenderDelegate *renderDelegate)
{
    delete renderDelegate;
}

#if PXR_VERSION >= 2511
bool HdUmberRendererPlugin::IsSupported(HdRendererCreateArgs const &, std::string *) const
#else
bool HdUmberRendererPlugin::IsSupported(bool) const
#endif
{
    return true;
}

PXR_NAMESPACE_CLOSE_SCOPE
