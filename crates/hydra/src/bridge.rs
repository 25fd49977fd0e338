//! Everything that C++ and Rust know of each other: the only bridge.
//!
//! Each function returns a `Result`: what it carries reaches C++ as `rust::Error`, which the shim
//! posts as a Tf error (`cpp_shim/report.h`).

use crate::buffer::{RenderBuffer, new_render_buffer};
use crate::camera::{Camera, new_camera};
use crate::delegate::{Delegate, aov_rows, new_delegate, setting_rows};
use crate::instancer::{Instancer, new_instancer};
use crate::light::{Light, light_parameters, new_light};
use crate::material::{Material, new_material};
use crate::mesh::{Mesh, mesh_primvars, new_mesh};

#[cxx::bridge(namespace = "umber")]
pub mod ffi {
    /// Which member of a [`Value`] counts.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    enum ValueKind {
        Bool,
        Int,
        Float,
        Text,
    }

    /// A setting's or a figure's value.
    #[derive(Debug, Clone)]
    struct Value {
        kind: ValueKind,
        bool_value: bool,
        int_value: i64,
        float_value: f64,
        text_value: String,
    }

    /// A value with its name, and the name that a user reads.
    #[derive(Debug)]
    struct NamedValue {
        name: String,
        label: String,
        value: Value,
    }

    /// Pixel formats, by HdFormat's names.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    enum Format {
        UNorm8,
        UNorm8Vec2,
        UNorm8Vec3,
        UNorm8Vec4,
        Float16,
        Float16Vec2,
        Float16Vec3,
        Float16Vec4,
        Float32,
        Float32Vec2,
        Float32Vec3,
        Float32Vec4,
        Int32,
        Other,
    }

    /// An AOV that Umber renders: what GetDefaultAovDescriptor answers.
    #[derive(Debug)]
    struct AovDescription {
        name: String,
        format: Format,
        clear: f32,
    }

    /// A warning or an error for the user.
    #[derive(Debug)]
    struct Report {
        is_error: bool,
        text: String,
    }

    /// What a render pass is to show.
    #[derive(Debug)]
    struct Frame {
        width: usize,
        height: usize,
        /// Where the camera's view lies, in pixels of the buffers with y down: min x, min y, max x,
        /// max y. Empty: the whole buffer.
        display_window: Vec<f64>,
        pixel_aspect: f64,
        /// AOVs that are bound to buffers.
        aovs: Vec<String>,
        clear_color: [f32; 4],
        /// Hydra's render tags; empty: all.
        render_tags: Vec<String>,
    }

    /// CameraUtilConformWindowPolicy.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    enum WindowPolicy {
        MatchVertically,
        MatchHorizontally,
        Fit,
        Crop,
        DontConform,
    }

    /// HdCamera's attributes, in its units.
    #[derive(Debug)]
    struct CameraAttributes {
        /// Row-major, row vectors.
        transform: [f64; 16],
        orthographic: bool,
        horizontal_aperture: f32,
        vertical_aperture: f32,
        horizontal_aperture_offset: f32,
        vertical_aperture_offset: f32,
        focal_length: f32,
        near: f32,
        far: f32,
        window_policy: WindowPolicy,
    }

    /// Light prim types.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    enum LightType {
        Distant,
        Dome,
        Rect,
        Sphere,
        Disk,
        Cylinder,
        /// `light`: a portal, or nothing that Umber knows.
        Other,
        /// The mesh at the light's own path.
        Mesh,
    }

    /// HdInterpolation.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    enum Interpolation {
        Constant,
        Uniform,
        Varying,
        Vertex,
        FaceVarying,
        Instance,
    }

    /// HdCullStyle.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    enum CullStyle {
        DontCare,
        Nothing,
        Back,
        BackUnlessDoubleSided,
        Front,
        FrontUnlessDoubleSided,
    }

    extern "Rust" {
        type Delegate;
        /// Rows of the settings table.
        fn setting_rows() -> Result<Vec<NamedValue>>;
        /// Rows of the AOV table.
        fn aov_rows() -> Result<Vec<AovDescription>>;
        fn new_delegate() -> Result<Box<Delegate>>;
        /// False where Umber has no such setting.
        fn set_setting(self: &Delegate, key: &str, value: &Value) -> Result<bool>;
        fn stats(self: &Delegate) -> Result<Vec<NamedValue>>;
        /// What the user has not been told yet.
        fn take_reports(self: &Delegate) -> Result<Vec<Report>>;
        fn set_paused(self: &Delegate, paused: bool) -> Result<()>;
        fn is_paused(self: &Delegate) -> Result<bool>;
        fn stop(self: &Delegate) -> Result<()>;
        fn is_stopped(self: &Delegate) -> Result<bool>;
        fn restart(self: &Delegate) -> Result<()>;
        fn is_converged(self: &Delegate) -> Result<bool>;
        /// Looks through a camera that only its matrices describe (row-major, row vectors).
        fn look_by_matrices(
            self: &Delegate,
            world_to_view: &[f64; 16],
            projection: &[f64; 16],
            policy: WindowPolicy,
        ) -> Result<()>;
        /// Renders a frame in the background; one without AOVs not at all.
        fn render(self: &Delegate, frame: &Frame) -> Result<()>;
    }

    extern "Rust" {
        type RenderBuffer;
        fn new_render_buffer(delegate: &Delegate, path: &str) -> Result<Box<RenderBuffer>>;
        /// False where Umber cannot write that format.
        fn allocate(self: &RenderBuffer, width: usize, height: usize, format: Format) -> Result<bool>;
        fn deallocate(self: &RenderBuffer) -> Result<()>;
        /// Shows an AOV from now on. False where Umber has none of that name: the buffer then holds
        /// its clear value.
        fn bind(self: &RenderBuffer, aov: &str, clear_value: &[f32]) -> Result<bool>;
        /// The pixels as they stand, until as many `unmap` as `map`. Null where there are none.
        fn map(self: &RenderBuffer) -> Result<*mut u8>;
        fn unmap(self: &RenderBuffer) -> Result<()>;
        fn is_mapped(self: &RenderBuffer) -> Result<bool>;
        fn is_converged(self: &RenderBuffer) -> Result<bool>;
    }

    extern "Rust" {
        type Camera;
        fn new_camera(delegate: &Delegate, path: &str) -> Result<Box<Camera>>;
        fn set(self: &mut Camera, attributes: &CameraAttributes) -> Result<()>;
        /// Looks through this camera, with the window policy of the render pass.
        fn look_through(self: &mut Camera, policy: WindowPolicy) -> Result<()>;
        fn remove(self: &Camera) -> Result<()>;
    }

    extern "Rust" {
        type Light;
        /// Names of the parameters that Umber reads.
        fn light_parameters() -> Result<Vec<String>>;
        fn new_light(delegate: &Delegate, path: &str, light_type: LightType) -> Result<Box<Light>>;
        fn set_transform(self: &mut Light, matrix: &[f64; 16]) -> Result<()>;
        fn set_dome_offset(self: &mut Light, matrix: &[f64; 16]) -> Result<()>;
        fn set_visible(self: &mut Light, visible: bool) -> Result<()>;
        /// Gives all parameters their fallbacks.
        fn reset_parameters(self: &mut Light) -> Result<()>;
        fn set_numbers(self: &mut Light, parameter: &str, numbers: &[f32]) -> Result<()>;
        fn set_text(self: &mut Light, parameter: &str, text: &str) -> Result<()>;
        fn set_paths(self: &mut Light, parameter: &str, paths: &[&str]) -> Result<()>;
        fn commit(self: &Light) -> Result<()>;
        fn remove(self: &Light) -> Result<()>;
    }

    extern "Rust" {
        type Material;
        fn new_material(delegate: &Delegate, path: &str) -> Result<Box<Material>>;
        /// Begins a description: the node that the surface terminal leads to, or nothing.
        fn set_surface(self: &mut Material, node_type: &str) -> Result<()>;
        fn set_numbers(self: &mut Material, input: &str, numbers: &[f32]) -> Result<()>;
        fn set_text(self: &mut Material, input: &str, text: &str) -> Result<()>;
        /// An input that another node's output feeds; `fallback` is that node's, empty where it has none.
        fn set_connection(
            self: &mut Material,
            input: &str,
            node_type: &str,
            output: &str,
            fallback: &[f32],
        ) -> Result<()>;
        fn commit(self: &Material) -> Result<()>;
        fn remove(self: &Material) -> Result<()>;
    }

    extern "Rust" {
        type Instancer;
        fn new_instancer(delegate: &Delegate, path: &str) -> Result<Box<Instancer>>;
        /// The instancer above, or an empty path, and which of its instances show this one.
        fn set_parent(self: &mut Instancer, path: &str, indices: &[i32]) -> Result<()>;
        /// One matrix an instance (row-major, row vectors), one after another.
        fn set_transforms(self: &mut Instancer, matrices: &[f64]) -> Result<()>;
        fn set_visible(self: &mut Instancer, visible: bool) -> Result<()>;
        /// Begins the list of categories: one entry an instance, or one for all.
        fn clear_categories(self: &mut Instancer) -> Result<()>;
        fn add_categories(self: &mut Instancer, categories: &[&str]) -> Result<()>;
        fn commit(self: &mut Instancer) -> Result<()>;
        fn remove(self: &mut Instancer) -> Result<()>;
    }

    extern "Rust" {
        type Mesh;
        /// Names of the primvars that Umber reads, points aside.
        fn mesh_primvars() -> Result<Vec<String>>;
        fn new_mesh(delegate: &Delegate, path: &str) -> Result<Box<Mesh>>;
        fn set_topology(
            self: &mut Mesh,
            scheme: &str,
            orientation: &str,
            face_vertex_counts: &[i32],
            face_vertex_indices: &[i32],
            hole_indices: &[i32],
        ) -> Result<()>;
        /// Begins the list of subsets.
        fn clear_subsets(self: &mut Mesh) -> Result<()>;
        /// Faces with a material of their own; an empty path takes the mesh's.
        fn add_subset(self: &mut Mesh, material: &str, faces: &[i32]) -> Result<()>;
        fn set_points(self: &mut Mesh, points: &[f32]) -> Result<()>;
        fn set_primvar(
            self: &mut Mesh,
            name: &str,
            interpolation: Interpolation,
            components: usize,
            values: &[f32],
        ) -> Result<()>;
        /// Takes a primvar away that there may have been.
        fn clear_primvar(self: &mut Mesh, name: &str) -> Result<()>;
        fn set_transform(self: &mut Mesh, matrix: &[f64; 16]) -> Result<()>;
        fn set_visible(self: &mut Mesh, visible: bool) -> Result<()>;
        fn set_double_sided(self: &mut Mesh, double_sided: bool) -> Result<()>;
        fn set_cull_style(self: &mut Mesh, style: CullStyle) -> Result<()>;
        fn set_material(self: &mut Mesh, path: &str) -> Result<()>;
        /// The innermost instancer, or an empty path, and which of its instances show this mesh.
        fn set_instancer(self: &mut Mesh, path: &str, indices: &[i32]) -> Result<()>;
        fn set_prim_id(self: &mut Mesh, prim_id: i32) -> Result<()>;
        /// Categories that lights' links name.
        fn set_categories(self: &mut Mesh, categories: &[&str]) -> Result<()>;
        /// Sent at once where the mesh is known already: Hydra does not sync what no tag shows.
        fn set_render_tag(self: &mut Mesh, tag: &str) -> Result<()>;
        fn commit(self: &mut Mesh) -> Result<()>;
        fn remove(self: &mut Mesh) -> Result<()>;
    }
}
