//! What AOVs keep of what is seen at pixels' middles.

use umber_bvh::Hit;
use umber_math::{Normal3, Point3, Vector3};

use super::super::center::seen;
use super::placement::Placement;
use super::project::{Grid, Homogeneous};
use super::surface::shading_normal;
use crate::film::CenterHit;
use crate::scene::RenderScene;

/// What a triangle of a placement shows at a pixel. `direction`: of the view ray.
pub fn center(
    scene: &RenderScene,
    grid: &Grid,
    (placement, index): (&Placement, u32),
    pixel: [i32; 2],
    direction: Vector3,
) -> CenterHit {
    let mesh = placement.mesh(scene);
    let corners = mesh.shape.triangle(index).map(|p| placement.film_from_object.apply(p));
    let barycentrics = barycentrics(grid, &corners, grid.film_position(pixel));
    let [p, q, r] = mesh.shape.triangle(index).map(|p| p.0);
    let point = Point3(p * barycentrics[0] + q * barycentrics[1] + r * barycentrics[2]);
    let depths = scene.camera.depths_at(placement.film_from_object.apply(point).distance as f32);
    let normal = Normal3(shading_normal(placement, mesh, index, barycentrics)).normalized();
    let hit = Hit { t: 0.0, barycentrics, mesh: placement.mesh, triangle: index, path: placement.path };
    seen(scene, &hit, depths, normal, direction)
}

/// The barycentrics at a film position from the film's middle; each between 0 and 1.
#[inline]
pub fn barycentrics(grid: &Grid, corners: &[Homogeneous; 3], [x, y]: [f64; 2]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| {
        let weight = grid.weight(&p);
        [p.x - x * weight, p.y - y * weight]
    });
    // each is as the area that the position spans with the other two
    let area = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let areas = [area(b, c), area(c, a), area(a, b)];
    let scale = 1.0 / (areas[0] + areas[1] + areas[2]);
    let weights = areas.map(|area| (area * scale) as f32);
    // seen edge on, by rounding alone
    if scale.is_finite() { weights.map(|w| w.clamp(0.0, 1.0)) } else { [1.0 / 3.0; 3] }
}
