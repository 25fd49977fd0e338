#include "renderPass.h"

#include "camera.h"
#include "conversions.h"
#include "renderBuffer.h"
#include "report.h"

#include "pxr/imaging/hd/aov.h"
#include "pxr/imaging/hd/renderIndex.h"
#include "pxr/imaging/hd/tokens.h"

#include <algorithm>

PXR_NAMESPACE_OPEN_SCOPE

HdUmberRenderPass::HdUmberRenderPass(HdRenderIndex *index, HdRprimCollection const &collection,
                                     umber::Delegate const &delegate)
    : HdRenderPass(index, collection)
    , _delegate(delegate)
{
}

/// Hosts that execute once and then only ask (Blender's final render) learn of warnings here.
bool HdUmberRenderPass::IsConverged() const
{
    HdUmberPostReports(_delegate);
    bool converged = true;
    if (_rendering) {
        HdUmberForward(SdfPath(), [&] { converged = _delegate.is_converged(); });
    }
    return converged;
}

void HdUmberRenderPass::_Execute(HdRenderPassStateSharedPtr const &state,
                                 TfTokenVector const &renderTags)
{
    HdUmberForward(SdfPath(), [&] {
        umber::Frame frame{};
        frame.pixel_aspect = 1.0;
        _Bind(state->GetAovBindings(), &frame);
        CameraUtilFraming const &framing = state->GetFraming();
        if (framing.IsValid()) {
            GfVec2f const &min = framing.displayWindow.GetMin();
            GfVec2f const &max = framing.displayWindow.GetMax();
            for (float const edge : {min[0], min[1], max[0], max[1]}) {
                frame.display_window.push_back(edge);
            }
            frame.pixel_aspect = framing.pixelAspectRatio;
        }
        for (TfToken const &tag : renderTags) {
            frame.render_tags.push_back(tag.GetString());
        }
        _rendering = !frame.aovs.empty();
        _Look(*state);
        _delegate.render(frame);
    });
    HdUmberPostReports(_delegate);
}

void HdUmberRenderPass::_Bind(HdRenderPassAovBindingVector const &bindings,
                              umber::Frame *frame) const
{
    for (HdRenderPassAovBinding const &binding : bindings) {
        HdBprim *bprim = binding.renderBuffer;
        if (!bprim) {
            bprim = GetRenderIndex()->GetBprim(HdPrimTypeTokens->renderBuffer, binding.renderBufferId);
        }
        auto *buffer = dynamic_cast<HdUmberRenderBuffer *>(bprim);
        if (!buffer || !buffer->Bind(binding)) {
            continue;
        }
        if (frame->aovs.empty()) {
            frame->width = buffer->GetWidth();
            frame->height = buffer->GetHeight();
        }
        frame->aovs.push_back(binding.aovName.GetString());
        if (binding.aovName == HdAovTokens->color) {
            std::vector<float> const clear = HdUmberReadNumbers(binding.clearValue).values;
            size_t const count = std::min(clear.size(), frame->clear_color.size());
            std::copy_n(clear.begin(), count, frame->clear_color.begin());
        }
    }
}

void HdUmberRenderPass::_Look(HdRenderPassState const &state) const
{
    umber::WindowPolicy const policy = HdUmberWindowPolicy(state.GetWindowPolicy());
    if (auto const *camera = dynamic_cast<HdUmberCamera const *>(state.GetCamera())) {
        camera->LookThrough(policy);
        return;
    }
    // The matrices of a state without camera already fit the viewport.
    _delegate.look_by_matrices(HdUmberMatrix(state.GetWorldToViewMatrix()),
                               HdUmberMatrix(state.GetProjectionMatrix()),
                               umber::WindowPolicy::DontConform);
}

PXR_NAMESPACE_CLOSE_SCOPE
