#ifndef UMBER_CPP_SHIM_LIGHT_LINKING_H
#define UMBER_CPP_SHIM_LIGHT_LINKING_H

#include "pxr/pxr.h"
#include "pxr/imaging/hd/filteringSceneIndex.h"

PXR_NAMESPACE_OPEN_SCOPE

/// The scene with lights' collections resolved to categories, where it has them as collections.
HdSceneIndexBaseRefPtr HdUmberResolveLightLinking(HdSceneIndexBaseRefPtr const &inputScene,
                                                  HdContainerDataSourceHandle const &inputArgs);

PXR_NAMESPACE_CLOSE_SCOPE

#endif
