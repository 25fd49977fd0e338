#include "instanceTransforms.h"

#include "pxr/base/gf/matrix4d.h"
#include "pxr/base/gf/matrix4f.h"
#include "pxr/base/gf/quatd.h"
#include "pxr/base/gf/quatf.h"
#include "pxr/base/gf/quath.h"
#include "pxr/base/gf/vec3d.h"
#include "pxr/base/gf/vec3f.h"
#include "pxr/base/gf/vec3h.h"
#include "pxr/base/gf/vec4f.h"
#include "pxr/base/vt/array.h"
#include "pxr/imaging/hd/tokens.h"

#include <algorithm>

PXR_NAMESPACE_OPEN_SCOPE

namespace {

/// Rotations sent as vectors hold the real part first.
GfQuatd _Quaternion(GfVec4f const &v) { return GfQuatd(v[0], v[1], v[2], v[3]); }
template <class Quat>
GfQuatd _Quaternion(Quat const &quat) { return GfQuatd(quat); }

/// Puts a matrix made from each element before what there is, as row vectors read it.
template <class T, class MatrixOf>
bool _Apply(VtValue const &value, MatrixOf const &matrixOf, GfMatrix4d const &outer,
            VtMatrix4dArray *transforms)
{
    if (!value.IsHolding<VtArray<T>>()) {
        return false;
    }
    VtArray<T> const &elements = value.UncheckedGet<VtArray<T>>();
    if (elements.size() > transforms->size()) {
        transforms->resize(elements.size(), outer);
    }
    GfMatrix4d *out = transforms->data();
    for (size_t i = 0; i < elements.size(); ++i) {
        out[i] = matrixOf(elements[i]) * out[i];
    }
    return true;
}

template <class... Types, class MatrixOf>
void _ApplyAny(VtValue const &value, MatrixOf const &matrixOf, GfMatrix4d const &outer,
               VtMatrix4dArray *transforms)
{
    (_Apply<Types>(value, matrixOf, outer, transforms) || ...);
}

} // namespace

VtMatrix4dArray HdUmberInstanceTransforms(HdSceneDelegate *delegate, SdfPath const &instancerId)
{
    GfMatrix4d const outer = delegate->GetInstancerTransform(instancerId);
    VtMatrix4dArray transforms;
    _ApplyAny<GfVec3f, GfVec3d, GfVec3h>(
        delegate->Get(instancerId, HdInstancerTokens->instanceTranslations),
        [](auto const &v) { return GfMatrix4d(1.0).SetTranslate(GfVec3d(v)); }, outer, &transforms);
    _ApplyAny<GfQuath, GfQuatf, GfQuatd, GfVec4f>(
        delegate->Get(instancerId, HdInstancerTokens->instanceRotations),
        [](auto const &q) { return GfMatrix4d(1.0).SetRotate(_Quaternion(q)); }, outer, &transforms);
    _ApplyAny<GfVec3f, GfVec3d, GfVec3h>(
        delegate->Get(instancerId, HdInstancerTokens->instanceScales),
        [](auto const &v) { return GfMatrix4d(1.0).SetScale(GfVec3d(v)); }, outer, &transforms);
    _ApplyAny<GfMatrix4d, GfMatrix4f>(
        delegate->Get(instancerId, HdInstancerTokens->instanceTransforms),
        [](auto const &m) { return GfMatrix4d(m); }, outer, &transforms);
    return transforms;
}

PXR_NAMESPACE_CLOSE_SCOPE
