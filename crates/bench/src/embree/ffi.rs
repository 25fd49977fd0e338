//! The part of Embree 3's C interface that is used, after its headers (`rtcore_*.h`, 3.13).
//!
//! Values of enumerations are those of the headers; `RTC_MAX_INSTANCE_LEVEL_COUNT` is 1, as packaged.

use std::ffi::{c_char, c_uint, c_void};

/// A device, geometry or scene: opaque, counted by references.
pub type Handle = *mut c_void;

/// `RTC_GEOMETRY_TYPE_TRIANGLE`
pub const TYPE_TRIANGLE: c_uint = 0;
/// `RTC_GEOMETRY_TYPE_INSTANCE`
pub const TYPE_INSTANCE: c_uint = 121;
/// `RTC_BUFFER_TYPE_INDEX`
pub const BUFFER_INDEX: c_uint = 0;
/// `RTC_BUFFER_TYPE_VERTEX`
pub const BUFFER_VERTEX: c_uint = 1;
/// `RTC_FORMAT_UINT3`
pub const FORMAT_UINT3: c_uint = 0x5003;
/// `RTC_FORMAT_FLOAT3`
pub const FORMAT_FLOAT3: c_uint = 0x9003;
/// `RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR`
pub const FORMAT_FLOAT3X4_COLUMN_MAJOR: c_uint = 0x9234;
/// `RTC_SCENE_FLAG_ROBUST`
pub const SCENE_ROBUST: c_uint = 1 << 2;
/// `RTC_BUILD_QUALITY_MEDIUM`
pub const QUALITY_MEDIUM: c_uint = 1;
/// `RTC_INVALID_GEOMETRY_ID`
pub const INVALID_ID: c_uint = c_uint::MAX;

/// `RTCRay`
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub struct RtcRay {
    pub origin: [f32; 3],
    pub near: f32,
    pub direction: [f32; 3],
    pub time: f32,
    pub far: f32,
    pub mask: c_uint,
    pub id: c_uint,
    pub flags: c_uint,
}

/// `RTCHit`
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub struct RtcHit {
    pub normal: [f32; 3],
    pub uv: [f32; 2],
    pub primitive: c_uint,
    pub geometry: c_uint,
    pub instance: c_uint,
}

/// `RTCRayHit`
#[repr(C)]
#[derive(Clone, Copy)]
pub struct RtcRayHit {
    pub ray: RtcRay,
    pub hit: RtcHit,
}

/// `RTCIntersectContext`
#[repr(C)]
#[derive(Clone, Copy)]
pub struct RtcContext {
    pub flags: c_uint,
    pub filter: *const c_void,
    pub instance: c_uint,
    /// There where Embree was built with `RTC_MIN_WIDTH`.
    pub min_width_factor: f32,
}

/// `RTCMemoryMonitorFunction`
pub type MemoryMonitor = unsafe extern "C" fn(user: *mut c_void, bytes: isize, post: bool) -> bool;

// SAFETY: the signatures are those of the headers.
unsafe extern "C" {
    pub fn rtcNewDevice(config: *const c_char) -> Handle;
    pub fn rtcReleaseDevice(device: Handle);
    pub fn rtcGetDeviceProperty(device: Handle, property: c_uint) -> isize;
    pub fn rtcGetDeviceError(device: Handle) -> c_uint;
    pub fn rtcSetDeviceMemoryMonitorFunction(device: Handle, monitor: Option<MemoryMonitor>, user: *mut c_void);
    pub fn rtcNewScene(device: Handle) -> Handle;
    pub fn rtcReleaseScene(scene: Handle);
    pub fn rtcSetSceneFlags(scene: Handle, flags: c_uint);
    pub fn rtcSetSceneBuildQuality(scene: Handle, quality: c_uint);
    pub fn rtcCommitScene(scene: Handle);
    pub fn rtcAttachGeometry(scene: Handle, geometry: Handle) -> c_uint;
    pub fn rtcNewGeometry(device: Handle, kind: c_uint) -> Handle;
    pub fn rtcReleaseGeometry(geometry: Handle);
    pub fn rtcCommitGeometry(geometry: Handle);
    pub fn rtcSetNewGeometryBuffer(
        geometry: Handle,
        buffer: c_uint,
        slot: c_uint,
        format: c_uint,
        stride: usize,
        count: usize,
    ) -> *mut c_void;
    pub fn rtcSetGeometryInstancedScene(geometry: Handle, scene: Handle);
    pub fn rtcSetGeometryTransform(geometry: Handle, step: c_uint, format: c_uint, matrix: *const c_void);
    pub fn rtcIntersect1(scene: Handle, context: *mut RtcContext, ray: *mut RtcRayHit);
    pub fn rtcOccluded1(scene: Handle, context: *mut RtcContext, ray: *mut RtcRay);
}
