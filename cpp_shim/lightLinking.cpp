#include "lightLinking.h"

#include "pxr/imaging/hd/collectionSchema.h"
#include "pxr/imaging/hd/collectionsSchema.h"
#include "pxr/imaging/hd/sceneIndexObserver.h"
#include "pxr/imaging/hd/tokens.h"
#include "pxr/imaging/hdsi/lightLinkingSceneIndex.h"

PXR_NAMESPACE_OPEN_SCOPE

namespace {

/// Passes a light whose collections changed on as one that went and came back: HdsiLightLinkingSceneIndex of OpenUSD
/// 25.08 reads freed memory where a collection that it knows changes (`_Cache::ProcessCollection`).
class _RelinkingSceneIndex final : public HdSingleInputFilteringSceneIndexBase
{
public:
    explicit _RelinkingSceneIndex(HdSceneIndexBaseRefPtr const &inputScene)
        : HdSingleInputFilteringSceneIndexBase(inputScene)
    {
    }

    HdSceneIndexPrim GetPrim(SdfPath const &path) const override
    {
        return _GetInputSceneIndex()->GetPrim(path);
    }

    SdfPathVector GetChildPrimPaths(SdfPath const &path) const override
    {
        return _GetInputSceneIndex()->GetChildPrimPaths(path);
    }

protected:
    void _PrimsAdded(HdSceneIndexBase const &,
                     HdSceneIndexObserver::AddedPrimEntries const &entries) override
    {
        _SendPrimsAdded(entries);
    }

    void _PrimsRemoved(HdSceneIndexBase const &,
                       HdSceneIndexObserver::RemovedPrimEntries const &entries) override
    {
        _SendPrimsRemoved(entries);
    }

    void _PrimsDirtied(HdSceneIndexBase const &,
                       HdSceneIndexObserver::DirtiedPrimEntries const &entries) override
    {
        HdSceneIndexObserver::AddedPrimEntries gone, back;
        HdSceneIndexObserver::DirtiedPrimEntries others;
        for (HdSceneIndexObserver::DirtiedPrimEntry const &entry : entries) {
            HdSceneIndexPrim const prim = _IsOfCollections(entry) ? GetPrim(entry.primPath)
                                                                  : HdSceneIndexPrim();
            if (HdPrimTypeIsLight(prim.primType) && _HasLinks(prim)) {
                // without a type it is no light; its children stay
                gone.push_back({entry.primPath, TfToken()});
                back.push_back({entry.primPath, prim.primType});
            } else {
                others.push_back(entry);
            }
        }
        if (!gone.empty()) {
            _SendPrimsAdded(gone);
            _SendPrimsAdded(back);
        }
        if (!others.empty()) {
            _SendPrimsDirtied(others);
        }
    }

private:
    static bool _IsOfCollections(HdSceneIndexObserver::DirtiedPrimEntry const &entry)
    {
        return entry.dirtyLocators.Intersects(HdCollectionsSchema::GetDefaultLocator());
    }

    /// Legacy scene delegates resolve collections themselves and have none here.
    static bool _HasLinks(HdSceneIndexPrim const &prim)
    {
        HdCollectionsSchema collections = HdCollectionsSchema::GetFromParent(prim.dataSource);
        if (!collections) {
            return false;
        }
        return collections.GetCollection(HdTokens->lightLink).GetMembershipExpression() ||
               collections.GetCollection(HdTokens->shadowLink).GetMembershipExpression();
    }
};

} // namespace

HdSceneIndexBaseRefPtr HdUmberResolveLightLinking(HdSceneIndexBaseRefPtr const &inputScene,
                                                  HdContainerDataSourceHandle const &inputArgs)
{
    HdSceneIndexBaseRefPtr const relinking = TfCreateRefPtr(new _RelinkingSceneIndex(inputScene));
    return HdsiLightLinkingSceneIndex::New(relinking, inputArgs);
}

PXR_NAMESPACE_CLOSE_SCOPE
