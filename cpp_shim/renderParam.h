#ifndef UMBER_CPP_SHIM_RENDER_PARAM_H
#define UMBER_CPP_SHIM_RENDER_PARAM_H

#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/imaging/hd/renderDelegate.h"

#include <atomic>

PXR_NAMESPACE_OPEN_SCOPE

/// What Hydra hands to every sync: the delegate's Rust half.
class HdUmberRenderParam final : public HdRenderParam
{
public:
    explicit HdUmberRenderParam(umber::Delegate &delegate) : _delegate(delegate) {}

    umber::Delegate &GetDelegate() const { return _delegate; }

    /// A light's collection may have other members: UsdImagingDelegate tells the members, but native instances.
    void NoteMembers() { _membersChanged = true; }
    bool TakeMembers() { return _membersChanged.exchange(false); }

private:
    umber::Delegate &_delegate;
    std::atomic<bool> _membersChanged{false};
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
