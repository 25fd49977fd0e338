#ifndef UMBER_CPP_SHIM_RENDER_BUFFER_H
#define UMBER_CPP_SHIM_RENDER_BUFFER_H

#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/imaging/hd/aov.h"
#include "pxr/imaging/hd/renderBuffer.h"

PXR_NAMESPACE_OPEN_SCOPE

/// Pixels that are filled from the film when the host maps them. The render thread never writes
/// here: neither allocating nor finalizing has to wait for it.
class HdUmberRenderBuffer final : public HdRenderBuffer
{
public:
    HdUmberRenderBuffer(SdfPath const &id, rust::Box<umber::RenderBuffer> buffer);

    /// Shows the binding's AOV. False where Umber has none of that name.
    bool Bind(HdRenderPassAovBinding const &binding);

    bool Allocate(GfVec3i const &dimensions, HdFormat format, bool multiSampled) override;
    unsigned int GetWidth() const override { return _width; }
    unsigned int GetHeight() const override { return _height; }
    unsigned int GetDepth() const override { return 1; }
    HdFormat GetFormat() const override { return _format; }
    bool IsMultiSampled() const override { return false; }

    void *Map() override;
    void Unmap() override;
    bool IsMapped() const override;
    void Resolve() override {}
    bool IsConverged() const override;

protected:
    void _Deallocate() override;

private:
    rust::Box<umber::RenderBuffer> _buffer;
    unsigned int _width = 0;
    unsigned int _height = 0;
    HdFormat _format = HdFormatInvalid;
};

PXR_NAMESPACE_CLOSE_SCOPE

#endif
