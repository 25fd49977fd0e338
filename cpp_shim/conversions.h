// Hydra's types as the plain numbers that cross the bridge.
#ifndef UMBER_CPP_SHIM_CONVERSIONS_H
#define UMBER_CPP_SHIM_CONVERSIONS_H

#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/base/gf/matrix4d.h"
#include "pxr/base/vt/array.h"
#include "pxr/base/vt/types.h"
#include "pxr/base/vt/value.h"
#include "pxr/imaging/cameraUtil/conformWindow.h"
#include "pxr/imaging/hd/enums.h"
#include "pxr/imaging/hd/types.h"
#include "pxr/usd/sdf/path.h"

#include <array>
#include <vector>

PXR_NAMESPACE_OPEN_SCOPE

/// Single-precision numbers of a value or an array, and how many belong together.
struct HdUmberNumbers
{
    std::vector<float> values;
    size_t components = 0;

    rust::Slice<const float> Slice() const { return {values.data(), values.size()}; }
};

/// Reads bool, integers, half, float, double, and vectors and arrays of the latter three.
/// Without components where the value holds anything else.
HdUmberNumbers HdUmberReadNumbers(VtValue const &value);

/// Reads tokens, strings and asset paths (as resolved, else as authored); empty for anything else.
std::string HdUmberReadText(VtValue const &value);

/// Numbers of a matrix, row after row.
std::array<double, 16> HdUmberMatrix(GfMatrix4d const &matrix);

/// A path's text.
rust::Str HdUmberText(SdfPath const &path);

/// A token's text.
rust::Str HdUmberText(TfToken const &token);

/// Texts of tokens and paths, for as long as these stand.
std::vector<rust::Str> HdUmberTexts(VtTokenArray const &tokens);
std::vector<rust::Str> HdUmberTexts(SdfPathVector const &paths);
inline rust::Slice<const rust::Str> HdUmberSlice(std::vector<rust::Str> const &texts)
{
    return {texts.data(), texts.size()};
}

/// Ints of an array, without a copy.
inline rust::Slice<const int32_t> HdUmberSlice(VtIntArray const &array)
{
    return {array.cdata(), array.size()};
}

umber::Format HdUmberFormat(HdFormat format);
HdFormat HdUmberHdFormat(umber::Format format);
umber::WindowPolicy HdUmberWindowPolicy(CameraUtilConformWindowPolicy policy);
umber::Interpolation HdUmberInterpolation(HdInterpolation interpolation);
umber::CullStyle HdUmberCullStyle(HdCullStyle style);

/// The bridge's word for a setting's value: false where it is neither bool, integer nor number.
bool HdUmberReadValue(VtValue const &value, umber::Value *out);
/// A setting's or a figure's value as Hydra's hosts expect it: bool, int, float.
VtValue HdUmberSettingValue(umber::Value const &value);
/// As a figure of GetRenderStats: bool, int64, double.
VtValue HdUmberStatValue(umber::Value const &value);

PXR_NAMESPACE_CLOSE_SCOPE

#endif
