#ifndef UMBER_CPP_SHIM_SCENE_INDEX_PLUGINS_H
#define UMBER_CPP_SHIM_SCENE_INDEX_PLUGINS_H

#include "pxr/pxr.h"
#include "pxr/imaging/hd/sceneIndexPlugin.h"

PXR_NAMESPACE_OPEN_SCOPE

// Scene indices that turn what Umber has no Rprim for into meshes, and one that resolves light linking.
// plugInfo.json names each of these classes, with the renderer's display name to load it for.

/// Spheres, cubes, cones, cylinders, capsules and planes.
class HdUmber_ImplicitSurfaceSceneIndexPlugin final : public HdSceneIndexPlugin
{
protected:
    HdSceneIndexBaseRefPtr _AppendSceneIndex(HdSceneIndexBaseRefPtr const &inputScene,
                                             HdContainerDataSourceHandle const &inputArgs) override;
};

/// Categories from the collections of lights, where the scene has them as collections: hosts on scene indices.
class HdUmber_LightLinkingSceneIndexPlugin final : public HdSceneIndexPlugin
{
protected:
    HdSceneIndexBaseRefPtr _AppendSceneIndex(HdSceneIndexBaseRefPtr const &inputScene,
                                             HdContainerDataSourceHandle const &inputArgs) override;
};

/// NURBS patches, by their control hull.
class HdUmber_NurbsSceneIndexPlugin final : public HdSceneIndexPlugin
{
protected:
    HdSceneIndexBaseRefPtr _AppendSceneIndex(HdSceneIndexBaseRefPtr const &inputScene,
                                             HdContainerDataSourceHandle const &inputArgs) override;
};

/// Tetrahedral meshes, by their surface.
class HdUmber_TetMeshSceneIndexPlugin final : public HdSceneIndexPlugin
{
protected:
    HdSceneIndexBaseRefPtr _AppendSceneIndex(HdSceneIndexBaseRefPtr const &inputScene,
                                             HdContainerDataSourceHandle const &inputArgs) override;
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
