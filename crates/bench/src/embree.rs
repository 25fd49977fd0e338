//! Embree as a peer: its single-ray queries, medium build quality, on one thread.

#[allow(missing_docs)]
mod ffi;

use std::{
    ffi::{CString, c_void},
    mem::MaybeUninit,
    ptr,
    sync::atomic::{AtomicI64, Ordering},
};

use anyhow::{Result, ensure};
use umber_math::{DAffine3, Ray};

use crate::{
    scenes::{Mesh, Scene},
    tracer::Tracer,
};

/// Bytes that the library holds, all devices together.
static HELD: AtomicI64 = AtomicI64::new(0);

unsafe extern "C" fn count_bytes(_: *mut c_void, bytes: isize, _: bool) -> bool {
    HELD.fetch_add(bytes as i64, Ordering::Relaxed);
    true
}

/// A device with the number of threads that its builds use.
pub struct Device(ffi::Handle);

impl Device {
    /// Opens a device.
    ///
    /// # Errors
    /// The library refuses.
    pub fn new(threads: usize) -> Result<Self> {
        let config = CString::new(format!("threads={threads}"))?;
        // SAFETY: the text ends in zero; the monitor needs no data of ours.
        let device = unsafe {
            let device = ffi::rtcNewDevice(config.as_ptr());
            ensure!(!device.is_null(), "Embree gives no device");
            ffi::rtcSetDeviceMemoryMonitorFunction(device, Some(count_bytes), ptr::null_mut());
            device
        };
        Ok(Self(device))
    }

    /// Its version, as in 3.13.5.
    pub fn version(&self) -> String {
        // SAFETY: the device is open; properties 1 to 3 are the numbers of the version.
        let number = |i| unsafe { ffi::rtcGetDeviceProperty(self.0, i) };
        format!("{}.{}.{}", number(1), number(2), number(3))
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the reference is ours, and is given back once.
        unsafe { ffi::rtcReleaseDevice(self.0) }
    }
}

/// A scene of one level, or of two where it has instances.
pub struct EmbreeScene {
    top: ffi::Handle,
    below: Vec<ffi::Handle>,
    /// What the hierarchies take, in bytes, without the buffers of points and indices.
    pub hierarchy_bytes: usize,
}

impl EmbreeScene {
    /// Builds it; `robust` is Embree's watertight mode.
    ///
    /// # Errors
    /// The library reports one.
    pub fn build(device: &Device, scene: &Scene, robust: bool) -> Result<Self> {
        let mut built = Self { top: ptr::null_mut(), below: Vec::new(), hierarchy_bytes: 0 };
        // SAFETY: handles are of this device, are attached while open, and geometries are released
        // once attached, since their scene holds them; matrices are twelve floats.
        unsafe {
            for mesh in &scene.meshes {
                let one = new_scene(device, robust);
                attach_mesh(device, one, mesh);
                built.commit(one);
                built.below.push(one);
            }
            if scene.is_flat() {
                built.top = built.below.pop().unwrap_or_else(|| new_scene(device, robust));
            } else {
                built.top = new_scene(device, robust);
                for instance in &scene.instances {
                    let geometry = ffi::rtcNewGeometry(device.0, ffi::TYPE_INSTANCE);
                    ffi::rtcSetGeometryInstancedScene(geometry, built.below[instance.mesh]);
                    let matrix = columns(&instance.transform);
                    let format = ffi::FORMAT_FLOAT3X4_COLUMN_MAJOR;
                    ffi::rtcSetGeometryTransform(geometry, 0, format, matrix.as_ptr().cast());
                    ffi::rtcCommitGeometry(geometry);
                    ffi::rtcAttachGeometry(built.top, geometry);
                    ffi::rtcReleaseGeometry(geometry);
                }
                built.commit(built.top);
            }
            let error = ffi::rtcGetDeviceError(device.0);
            ensure!(error == 0, "Embree reports error {error}");
        }
        Ok(built)
    }

    /// # Safety
    /// The scene is open.
    unsafe fn commit(&mut self, scene: ffi::Handle) {
        let before = HELD.load(Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { ffi::rtcCommitScene(scene) };
        self.hierarchy_bytes += usize::try_from(HELD.load(Ordering::Relaxed) - before).unwrap_or(0);
    }

    fn intersect(&self, ray: &Ray) -> Option<f32> {
        let mut context = context();
        let hit = ffi::RtcHit {
            normal: [0.0; 3],
            uv: [0.0; 2],
            primitive: ffi::INVALID_ID,
            geometry: ffi::INVALID_ID,
            instance: ffi::INVALID_ID,
        };
        let mut query = ffi::RtcRayHit { ray: rtc_ray(ray), hit };
        // SAFETY: the scene is committed; ray and context are as the headers lay them out.
        unsafe { ffi::rtcIntersect1(self.top, &mut context, &mut query) };
        (query.hit.geometry != ffi::INVALID_ID).then_some(query.ray.far)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let (mut context, mut query) = (context(), rtc_ray(ray));
        // SAFETY: as for the closest hit.
        unsafe { ffi::rtcOccluded1(self.top, &mut context, &mut query) };
        query.far == f32::NEG_INFINITY
    }
}

impl Drop for EmbreeScene {
    fn drop(&mut self) {
        for scene in self.below.drain(..).chain([self.top]).filter(|s| !s.is_null()) {
            // SAFETY: the reference is ours, and is given back once.
            unsafe { ffi::rtcReleaseScene(scene) }
        }
    }
}

impl Tracer for EmbreeScene {
    fn count_closest(&self, rays: &[Ray]) -> usize {
        rays.iter().filter(|r| self.intersect(r).is_some()).count()
    }
    fn count_any(&self, rays: &[Ray]) -> usize {
        rays.iter().filter(|r| self.occluded(r)).count()
    }
    fn closest(&self, ray: &Ray) -> Option<f32> {
        self.intersect(ray)
    }
    fn any(&self, ray: &Ray) -> bool {
        self.occluded(ray)
    }
}

/// # Safety
/// The device is open.
unsafe fn new_scene(device: &Device, robust: bool) -> ffi::Handle {
    // SAFETY: the caller's promise.
    unsafe {
        let scene = ffi::rtcNewScene(device.0);
        ffi::rtcSetSceneBuildQuality(scene, ffi::QUALITY_MEDIUM);
        ffi::rtcSetSceneFlags(scene, if robust { ffi::SCENE_ROBUST } else { 0 });
        scene
    }
}

/// # Safety
/// Device and scene are open.
unsafe fn attach_mesh(device: &Device, scene: ffi::Handle, mesh: &Mesh) {
    // SAFETY: the caller's promise; the buffers are as long as asked for, three numbers an item.
    unsafe {
        let geometry = ffi::rtcNewGeometry(device.0, ffi::TYPE_TRIANGLE);
        let new = |kind, format, count| ffi::rtcSetNewGeometryBuffer(geometry, kind, 0, format, 12, count);
        let points: *mut MaybeUninit<[f32; 3]> = new(ffi::BUFFER_VERTEX, ffi::FORMAT_FLOAT3, mesh.points.len()).cast();
        for (i, point) in mesh.points.iter().enumerate() {
            (*points.add(i)).write(point.0.to_array());
        }
        let indices: *mut MaybeUninit<[u32; 3]> =
            new(ffi::BUFFER_INDEX, ffi::FORMAT_UINT3, mesh.triangles.len()).cast();
        for (i, triangle) in mesh.triangles.iter().enumerate() {
            (*indices.add(i)).write(*triangle);
        }
        ffi::rtcCommitGeometry(geometry);
        ffi::rtcAttachGeometry(scene, geometry);
        ffi::rtcReleaseGeometry(geometry);
    }
}

fn columns(m: &DAffine3) -> [f32; 12] {
    m.to_cols_array().map(|x| x as f32)
}

fn context() -> ffi::RtcContext {
    ffi::RtcContext { flags: 0, filter: ptr::null(), instance: ffi::INVALID_ID, min_width_factor: 0.0 }
}

fn rtc_ray(ray: &Ray) -> ffi::RtcRay {
    let (origin, direction) = (ray.origin.0.to_array(), ray.direction.0.to_array());
    ffi::RtcRay { origin, near: ray.t_min, direction, time: 0.0, far: ray.t_max, mask: u32::MAX, id: 0, flags: 0 }
}
