#ifndef UMBER_CPP_SHIM_RENDER_PASS_H
#define UMBER_CPP_SHIM_RENDER_PASS_H

#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/imaging/hd/renderPass.h"
#include "pxr/imaging/hd/renderPassState.h"

PXR_NAMESPACE_OPEN_SCOPE

/// Says what to render into which buffers, and starts the renderer.
class HdUmberRenderPass final : public HdRenderPass
{
public:
    HdUmberRenderPass(HdRenderIndex *index, HdRprimCollection const &collection,
                      umber::Delegate const &delegate);

    bool IsConverged() const override;

protected:
    void _Execute(HdRenderPassStateSharedPtr const &state, TfTokenVector const &renderTags) override;

private:
    /// Binds the buffers and puts those that Umber renders into the frame.
    void _Bind(HdRenderPassAovBindingVector const &bindings, umber::Frame *frame) const;
    /// Looks through the state's camera, or what its matrices describe.
    void _Look(HdRenderPassState const &state) const;

    umber::Delegate const &_delegate;
    /// Whether the last execution had anything to render.
    bool _rendering = false;
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
