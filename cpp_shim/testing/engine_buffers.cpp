// For the host tests alone: what Python's UsdImagingGL.Engine leaves out. With it a driver script can ask for
// several AOVs at once and read their buffers back without a GPU. A C interface, for ctypes.

#include "pxr/pxr.h"

#include "pxr/external/boost/python.hpp"

#include "pxr/imaging/hd/renderBuffer.h"
#include "pxr/imaging/hd/types.h"
#include "pxr/usdImaging/usdImagingGL/engine.h"

#include <cstddef>
#include <cstring>

PXR_NAMESPACE_USING_DIRECTIVE

namespace {

UsdImagingGLEngine* EngineOf(PyObject* object)
{
    pxr_boost::python::extract<UsdImagingGLEngine*> engine(object);
    return engine.check() ? engine() : nullptr;
}

} // namespace

/// Where a buffer's size and layout go.
struct UmberBufferShape
{
    unsigned int width;
    unsigned int height;
    unsigned int components;
    /// As HdFormat counts component types: 0 UNorm8, 4 SNorm8, 8 Float16, 12 Float32, 24 Int32.
    int component;
    size_t bytes;
};

extern "C" {

/// Asks for the AOVs `names`. False where `engine` is no UsdImagingGL.Engine or refuses them.
bool umber_set_aovs(PyObject* engine, const char* const* names, size_t count)
{
    UsdImagingGLEngine* const self = EngineOf(engine);
    return self && self->SetRendererAovs(TfTokenVector(names, names + count));
}

/// The shape of the buffer of the AOV `name`. False where there is none.
bool umber_aov_shape(PyObject* engine, const char* name, UmberBufferShape* shape)
{
    UsdImagingGLEngine* const self = EngineOf(engine);
    const HdRenderBuffer* const buffer = self ? self->GetAovRenderBuffer(TfToken(name)) : nullptr;
    if (!buffer) {
        return false;
    }
    const HdFormat format = buffer->GetFormat();
    shape->width = buffer->GetWidth();
    shape->height = buffer->GetHeight();
    shape->components = static_cast<unsigned int>(HdGetComponentCount(format));
    shape->component = HdGetComponentFormat(format);
    shape->bytes = HdDataSizeOfFormat(format) * shape->width * shape->height;
    return true;
}

/// Copies the buffer of the AOV `name`, resolved, to `pixels`, lowest row first. False where it is gone or has
/// another size than `bytes`.
bool umber_read_aov(PyObject* engine, const char* name, void* pixels, size_t bytes)
{
    UmberBufferShape shape;
    if (!umber_aov_shape(engine, name, &shape) || shape.bytes != bytes) {
        return false;
    }
    HdRenderBuffer* const buffer = EngineOf(engine)->GetAovRenderBuffer(TfToken(name));
    buffer->Resolve();
    const void* const data = buffer->Map();
    if (data) {
        std::memcpy(pixels, data, bytes);
    }
    buffer->Unmap();
    return data != nullptr;
}

} // extern "C"
