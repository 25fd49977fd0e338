#include "sceneIndexPlugins.h"

#include "lightLinking.h"

#include "pxr/imaging/hd/retainedDataSource.h"
#include "pxr/imaging/hd/sceneIndexPluginRegistry.h"
#include "pxr/imaging/hd/tokens.h"
#include "pxr/imaging/hdsi/implicitSurfaceSceneIndex.h"
#include "pxr/imaging/hdsi/nurbsApproximatingSceneIndex.h"
#include "pxr/imaging/hdsi/tetMeshConversionSceneIndex.h"

PXR_NAMESPACE_OPEN_SCOPE

static char const *const _rendererDisplayName = "Umber";

TF_REGISTRY_FUNCTION(TfType)
{
    HdSceneIndexPluginRegistry::Define<HdUmber_ImplicitSurfaceSceneIndexPlugin>();
    HdSceneIndexPluginRegistry::Define<HdUmber_LightLinkingSceneIndexPlugin>();
    HdSceneIndexPluginRegistry::Define<HdUmber_NurbsSceneIndexPlugin>();
    HdSceneIndexPluginRegistry::Define<HdUmber_TetMeshSceneIndexPlugin>();
}

static void _Register(char const *plugin, HdContainerDataSourceHandle const &inputArgs)
{
    HdSceneIndexPluginRegistry::GetInstance().RegisterSceneIndexForRenderer(
        _rendererDisplayName, TfToken(plugin), inputArgs, /*insertionPhase=*/0,
        HdSceneIndexPluginRegistry::InsertionOrderAtStart);
}

TF_REGISTRY_FUNCTION(HdSceneIndexPlugin)
{
    HdDataSourceBaseHandle const toMesh =
        HdRetainedTypedSampledDataSource<TfToken>::New(HdsiImplicitSurfaceSceneIndexTokens->toMesh);
    _Register("HdUmber_ImplicitSurfaceSceneIndexPlugin",
              HdRetainedContainerDataSource::New(
                  HdPrimTypeTokens->sphere, toMesh, HdPrimTypeTokens->cube, toMesh,
                  HdPrimTypeTokens->cone, toMesh, HdPrimTypeTokens->cylinder, toMesh,
                  HdPrimTypeTokens->capsule, toMesh, HdPrimTypeTokens->plane, toMesh));
    _Register("HdUmber_LightLinkingSceneIndexPlugin", nullptr);
    _Register("HdUmber_NurbsSceneIndexPlugin", nullptr);
    _Register("HdUmber_TetMeshSceneIndexPlugin", nullptr);
}

HdSceneIndexBaseRefPtr HdUmber_ImplicitSurfaceSceneIndexPlugin::_AppendSceneIndex(
    HdSceneIndexBaseRefPtr const &inputScene, HdContainerDataSourceHandle const &inputArgs)
{
    return HdsiImplicitSurfaceSceneIndex::New(inputScene, inputArgs);
}

HdSceneIndexBaseRefPtr HdUmber_LightLinkingSceneIndexPlugin::_AppendSceneIndex(
    HdSceneIndexBaseRefPtr const &inputScene, HdContainerDataSourceHandle const &inputArgs)
{
    return HdUmberResolveLightLinking(inputScene, inputArgs);
}

HdSceneIndexBaseRefPtr HdUmber_NurbsSceneIndexPlugin::_AppendSceneIndex(
    HdSceneIndexBaseRefPtr const &inputScene, HdContainerDataSourceHandle const &)
{
    return HdsiNurbsApproximatingSceneIndex::New(inputScene);
}

HdSceneIndexBaseRefPtr HdUmber_TetMeshSceneIndexPlugin::_AppendSceneIndex(
    HdSceneIndexBaseRefPtr const &inputScene, HdContainerDataSourceHandle const &)
{
    return HdsiTetMeshConversionSceneIndex::New(inputScene);
}

PXR_NAMESPACE_CLOSE_SCOPE
