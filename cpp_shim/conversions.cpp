#include "conversions.h"

#include "pxr/base/gf/half.h"
#include "pxr/base/gf/vec2d.h"
#include "pxr/base/gf/vec2f.h"
#include "pxr/base/gf/vec2h.h"
#include "pxr/base/gf/vec3d.h"
#include "pxr/base/gf/vec3f.h"
#include "pxr/base/gf/vec3h.h"
#include "pxr/base/gf/vec4d.h"
#include "pxr/base/gf/vec4f.h"
#include "pxr/base/gf/vec4h.h"
#include "pxr/base/vt/array.h"
#include "pxr/usd/sdf/assetPath.h"

#include <algorithm>

PXR_NAMESPACE_OPEN_SCOPE

namespace {

void _Append(float value, HdUmberNumbers *out) { out->values.push_back(value); }
void _Append(double value, HdUmberNumbers *out) { out->values.push_back(float(value)); }
void _Append(GfHalf value, HdUmberNumbers *out) { out->values.push_back(float(value)); }
void _Append(bool value, HdUmberNumbers *out) { out->values.push_back(value ? 1.0f : 0.0f); }
void _Append(int value, HdUmberNumbers *out) { out->values.push_back(float(value)); }

template <class Vec>
auto _Append(Vec const &value, HdUmberNumbers *out) -> decltype(Vec::dimension, void())
{
    for (size_t i = 0; i < Vec::dimension; ++i) {
        _Append(value[i], out);
    }
}

/// Components of a scalar, or of a vector type.
template <class T, class = void>
struct _Components { static constexpr size_t value = 1; };
template <class T>
struct _Components<T, decltype(T::dimension, void())>
{
    static constexpr size_t value = T::dimension;
};

template <class T>
bool _Read(VtValue const &value, HdUmberNumbers *out)
{
    if (value.IsHolding<T>()) {
        out->components = _Components<T>::value;
        _Append(value.UncheckedGet<T>(), out);
        return true;
    }
    if (value.IsHolding<VtArray<T>>()) {
        VtArray<T> const &array = value.UncheckedGet<VtArray<T>>();
        out->components = _Components<T>::value;
        out->values.reserve(array.size() * out->components);
        for (T const &element : array) {
            _Append(element, out);
        }
        return true;
    }
    return false;
}

template <class... Types>
HdUmberNumbers _ReadAny(VtValue const &value)
{
    HdUmberNumbers out;
    (_Read<Types>(value, &out) || ...);
    return out;
}

} // namespace

HdUmberNumbers HdUmberReadNumbers(VtValue const &value)
{
    return _ReadAny<float, GfVec2f, GfVec3f, GfVec4f, double, GfVec2d, GfVec3d, GfVec4d, GfHalf,
                    GfVec2h, GfVec3h, GfVec4h, bool, int>(value);
}

std::string HdUmberReadText(VtValue const &value)
{
    if (value.IsHolding<TfToken>()) {
        return value.UncheckedGet<TfToken>().GetString();
    }
    if (value.IsHolding<std::string>()) {
        return value.UncheckedGet<std::string>();
    }
    if (value.IsHolding<SdfAssetPath>()) {
        SdfAssetPath const &asset = value.UncheckedGet<SdfAssetPath>();
        return asset.GetResolvedPath().empty() ? asset.GetAssetPath() : asset.GetResolvedPath();
    }
    return {};
}

std::array<double, 16> HdUmberMatrix(GfMatrix4d const &matrix)
{
    std::array<double, 16> out;
    std::copy_n(matrix.GetArray(), out.size(), out.begin());
    return out;
}

rust::Str HdUmberText(SdfPath const &path)
{
    return HdUmberText(path.GetAsToken());
}

rust::Str HdUmberText(TfToken const &token)
{
    return {token.GetString().data(), token.size()};
}

std::vector<rust::Str> HdUmberTexts(VtTokenArray const &tokens)
{
    std::vector<rust::Str> texts;
    texts.reserve(tokens.size());
    for (TfToken const &token : tokens) {
        texts.push_back(HdUmberText(token));
    }
    return texts;
}

std::vector<rust::Str> HdUmberTexts(SdfPathVector const &paths)
{
    std::vector<rust::Str> texts;
    texts.reserve(paths.size());
    for (SdfPath const &path : paths) {
        texts.push_back(HdUmberText(path));
    }
    return texts;
}

#define UMBER_FORMATS(APPLY)                                                                       \
    APPLY(UNorm8) APPLY(UNorm8Vec2) APPLY(UNorm8Vec3) APPLY(UNorm8Vec4)                            \
    APPLY(Float16) APPLY(Float16Vec2) APPLY(Float16Vec3) APPLY(Float16Vec4)                        \
    APPLY(Float32) APPLY(Float32Vec2) APPLY(Float32Vec3) APPLY(Float32Vec4) APPLY(Int32)

umber::Format HdUmberFormat(HdFormat format)
{
    switch (format) {
#define UMBER_CASE(name) case HdFormat##name: return umber::Format::name;
        UMBER_FORMATS(UMBER_CASE)
#undef UMBER_CASE
        default: return umber::Format::Other;
    }
}

HdFormat HdUmberHdFormat(umber::Format format)
{
    switch (format) {
#define UMBER_CASE(name) case umber::Format::name: return HdFormat##name;
        UMBER_FORMATS(UMBER_CASE)
#undef UMBER_CASE
        default: return HdFormatInvalid;
    }
}

umber::WindowPolicy HdUmberWindowPolicy(CameraUtilConformWindowPolicy policy)
{
    switch (policy) {
        case CameraUtilMatchVertically: return umber::WindowPolicy::MatchVertically;
        case CameraUtilMatchHorizontally: return umber::WindowPolicy::MatchHorizontally;
        case CameraUtilFit: return umber::WindowPolicy::Fit;
        case CameraUtilCrop: return umber::WindowPolicy::Crop;
        case CameraUtilDontConform: return umber::WindowPolicy::DontConform;
    }
    return umber::WindowPolicy::Fit;
}

umber::Interpolation HdUmberInterpolation(HdInterpolation interpolation)
{
    switch (interpolation) {
        case HdInterpolationConstant: return umber::Interpolation::Constant;
        case HdInterpolationUniform: return umber::Interpolation::Uniform;
        case HdInterpolationVarying: return umber::Interpolation::Varying;
        case HdInterpolationVertex: return umber::Interpolation::Vertex;
        case HdInterpolationFaceVarying: return umber::Interpolation::FaceVarying;
        default: return umber::Interpolation::Instance;
    }
}

umber::CullStyle HdUmberCullStyle(HdCullStyle style)
{
    switch (style) {
        case HdCullStyleNothing: return umber::CullStyle::Nothing;
        case HdCullStyleBack: return umber::CullStyle::Back;
        case HdCullStyleBackUnlessDoubleSided: return umber::CullStyle::BackUnlessDoubleSided;
        case HdCullStyleFront: return umber::CullStyle::Front;
        case HdCullStyleFrontUnlessDoubleSided: return umber::CullStyle::FrontUnlessDoubleSided;
        default: return umber::CullStyle::DontCare;
    }
}

bool HdUmberReadValue(VtValue const &value, umber::Value *out)
{
    *out = {umber::ValueKind::Float, false, 0, 0.0, rust::String()};
    if (value.IsHolding<bool>()) {
        out->kind = umber::ValueKind::Bool;
        out->bool_value = value.UncheckedGet<bool>();
    } else if (value.IsHolding<float>()) {
        out->float_value = value.UncheckedGet<float>();
    } else if (value.IsHolding<double>()) {
        out->float_value = value.UncheckedGet<double>();
    } else if (value.IsHolding<std::string>()) {
        out->kind = umber::ValueKind::Text;
        out->text_value = rust::String::lossy(value.UncheckedGet<std::string>());
    } else if (value.IsHolding<TfToken>()) {
        out->kind = umber::ValueKind::Text;
        out->text_value = rust::String::lossy(value.UncheckedGet<TfToken>().GetString());
    } else {
        VtValue const integer = VtValue::Cast<int64_t>(value);
        out->kind = umber::ValueKind::Int;
        out->int_value = integer.GetWithDefault<int64_t>(0);
        return integer.IsHolding<int64_t>();
    }
    return true;
}

VtValue HdUmberSettingValue(umber::Value const &value)
{
    switch (value.kind) {
        case umber::ValueKind::Bool: return VtValue(value.bool_value);
        case umber::ValueKind::Int: return VtValue(int(value.int_value));
        case umber::ValueKind::Text: return VtValue(std::string(value.text_value));
        default: return VtValue(float(value.float_value));
    }
}

VtValue HdUmberStatValue(umber::Value const &value)
{
    switch (value.kind) {
        case umber::ValueKind::Bool: return VtValue(value.bool_value);
        case umber::ValueKind::Int: return VtValue(int64_t(value.int_value));
        case umber::ValueKind::Text: return VtValue(std::string(value.text_value));
        default: return VtValue(value.float_value);
    }
}

PXR_NAMESPACE_CLOSE_SCOPE
