#include "renderBuffer.h"

#include "conversions.h"
#include "report.h"

PXR_NAMESPACE_OPEN_SCOPE

HdUmberRenderBuffer::HdUmberRenderBuffer(SdfPath const &id, rust::Box<umber::RenderBuffer> buffer)
    : HdRenderBuffer(id)
    , _buffer(std::move(buffer))
{
}

bool HdUmberRenderBuffer::Bind(HdRenderPassAovBinding const &binding)
{
    bool known = false;
    HdUmberForward(GetId(), [&] {
        HdUmberNumbers const clear = HdUmberReadNumbers(binding.clearValue);
        known = _buffer->bind(HdUmberText(binding.aovName), clear.Slice());
    });
    return known;
}

bool HdUmberRenderBuffer::Allocate(GfVec3i const &dimensions, HdFormat format, bool)
{
    _Deallocate();
    if (dimensions[0] < 0 || dimensions[1] < 0 || dimensions[2] != 1) {
        HdUmberReportFailure(GetId(), "render buffers are two-dimensional");
        return false;
    }
    bool writable = false;
    HdUmberForward(GetId(), [&] {
        writable = _buffer->allocate(dimensions[0], dimensions[1], HdUmberFormat(format));
        if (!writable) {
            HdUmberReportFailure(GetId(), "this pixel format is not supported");
        }
    });
    if (writable) {
        _width = dimensions[0];
        _height = dimensions[1];
        _format = format;
    }
    return writable;
}

void HdUmberRenderBuffer::_Deallocate()
{
    _width = 0;
    _height = 0;
    _format = HdFormatInvalid;
    HdUmberForward(GetId(), [&] { _buffer->deallocate(); });
}

void *HdUmberRenderBuffer::Map()
{
    void *pixels = nullptr;
    HdUmberForward(GetId(), [&] { pixels = _buffer->map(); });
    return pixels;
}

void HdUmberRenderBuffer::Unmap()
{
    HdUmberForward(GetId(), [&] { _buffer->unmap(); });
}

bool HdUmberRenderBuffer::IsMapped() const
{
    bool mapped = false;
    HdUmberForward(GetId(), [&] { mapped = _buffer->is_mapped(); });
    return mapped;
}

bool HdUmberRenderBuffer::IsConverged() const
{
    bool converged = true;
    HdUmberForward(GetId(), [&] { converged = _buffer->is_converged(); });
    return converged;
}

PXR_NAMESPACE_CLOSE_SCOPE
