//! Figures of a render, for `GetRenderStats` and `--stats`.

use umber_settings::Value;

/// What a render has done so far and what it works on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    /// Samples a pixel that every pixel has.
    pub samples_per_pixel: u32,
    /// Samples a pixel at which the picture is finished at the latest.
    pub target_samples_per_pixel: u32,
    /// Samples taken, over the number of pixels: more than every pixel has where pixels get what they need.
    pub mean_samples_per_pixel: f64,
    /// Mean relative variance of the pixels of the finished picture, by the difference of the halves of their samples;
    /// negative where `convergedVariance` is, or none has two.
    pub relative_variance: f64,
    /// How much of that is done, 0 to 100.
    pub percent_done: f64,
    /// Seconds spent rendering the picture, pauses left out.
    pub render_seconds: f64,
    /// Seconds spent on the last compile of the scene.
    pub compile_seconds: f64,
    /// Rays traced for the picture.
    pub rays: u64,
    /// Paths from smooth surfaces in the light; 0: none are followed.
    pub light_paths: u64,
    /// Pixels whose samples take more rays from the camera, as the rim of something bright runs through them.
    pub edge_pixels: u64,
    /// Pixels of a group that shares paths; 1: none are shared.
    pub path_group: u32,
    /// Samples of a pixel that begin with the same ray from the camera; 1: each has its own.
    pub samples_a_ray: u32,
    /// Render threads.
    pub threads: u32,
    /// Meshes that are shown.
    pub meshes: u64,
    /// Their triangles, each mesh counted once.
    pub triangles: u64,
    /// Mesh instances, nested ones multiplied out.
    pub instances: u64,
    /// Lights that shine.
    pub lights: u64,
    /// Materials in use.
    pub materials: u64,
    /// Bytes of geometry with its hierarchies.
    pub geometry_bytes: u64,
    /// Bytes of the film.
    pub film_bytes: u64,
    /// Meshes whose hierarchy the last compile built.
    pub built_meshes: u64,
    /// Whether the last compile built the top level.
    pub built_top_level: bool,
}

impl Stats {
    /// All figures by name, in Hydra's `GetRenderStats` words where it has some.
    pub fn rows(&self) -> Vec<(&'static str, Value)> {
        let int = |v: u64| Value::Int(v as i64);
        vec![
            ("percentDone", Value::Float(self.percent_done)),
            ("numCompletedSamples", int(self.samples_per_pixel.into())),
            ("targetSamples", int(self.target_samples_per_pixel.into())),
            ("meanSamples", Value::Float(self.mean_samples_per_pixel)),
            ("relativeVariance", Value::Float(self.relative_variance)),
            ("renderSeconds", Value::Float(self.render_seconds)),
            ("compileSeconds", Value::Float(self.compile_seconds)),
            ("rays", int(self.rays)),
            ("lightPaths", int(self.light_paths)),
            ("edgePixels", int(self.edge_pixels)),
            ("pathGroup", int(self.path_group.into())),
            ("samplesPerCameraRay", int(self.samples_a_ray.into())),
            ("threads", int(self.threads.into())),
            ("meshes", int(self.meshes)),
            ("triangles", int(self.triangles)),
            ("instances", int(self.instances)),
            ("lights", int(self.lights)),
            ("materials", int(self.materials)),
            ("geometryBytes", int(self.geometry_bytes)),
            ("filmBytes", int(self.film_bytes)),
            ("builtMeshes", int(self.built_meshes)),
            ("builtTopLevel", Value::Bool(self.built_top_level)),
        ]
    }
}
