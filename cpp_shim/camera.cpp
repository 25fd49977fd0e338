#include "camera.h"

#include "conversions.h"
#include "report.h"

PXR_NAMESPACE_OPEN_SCOPE

HdUmberCamera::HdUmberCamera(SdfPath const &id, rust::Box<umber::Camera> camera)
    : HdCamera(id)
    , _camera(std::move(camera))
{
}

void HdUmberCamera::Sync(HdSceneDelegate *delegate, HdRenderParam *param, HdDirtyBits *dirtyBits)
{
    if (*dirtyBits == Clean) {
        return;
    }
    HdCamera::Sync(delegate, param, dirtyBits);
    umber::CameraAttributes attributes;
    attributes.transform = HdUmberMatrix(GetTransform());
    attributes.orthographic = GetProjection() == HdCamera::Orthographic;
    attributes.horizontal_aperture = GetHorizontalAperture();
    attributes.vertical_aperture = GetVerticalAperture();
    attributes.horizontal_aperture_offset = GetHorizontalApertureOffset();
    attributes.vertical_aperture_offset = GetVerticalApertureOffset();
    attributes.focal_length = GetFocalLength();
    attributes.near = GetClippingRange().GetMin();
    attributes.far = GetClippingRange().GetMax();
    attributes.window_policy = HdUmberWindowPolicy(GetWindowPolicy());
    HdUmberForward(GetId(), [&] { _camera->set(attributes); });
}

void HdUmberCamera::Finalize(HdRenderParam *param)
{
    HdUmberForward(GetId(), [&] { _camera->remove(); });
    HdCamera::Finalize(param);
}

void HdUmberCamera::LookThrough(umber::WindowPolicy policy) const
{
    HdUmberForward(GetId(), [&] { _camera->look_through(policy); });
}

PXR_NAMESPACE_CLOSE_SCOPE
