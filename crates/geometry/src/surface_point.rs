//! Points of surfaces in render space, and the rays that leave them.

use glam::{DAffine3, DMat3, DVec3};
use umber_math::float::{MACHINE_EPSILON, offset_ray_origin};
use umber_math::{Normal3, Point3, Ray, Vector3};

/// A point of a triangle, brought to render space.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// The point, render space.
    pub point: Point3,
    /// Unit normal of the triangle, on the side that its winding names; zero where its area is zero. Render space.
    pub normal: Normal3,
    /// How far a ray must start from the point, along the normal, to start beside the triangle wherever rounding
    /// puts it on the way back to object space. Render-space units.
    pub clearance: f32,
}

impl SurfacePoint {
    /// A ray that leaves the surface, to the side of the normal that `direction` is on.
    #[inline]
    pub fn spawn_ray(&self, direction: Vector3) -> Ray {
        Ray::new(offset_ray_origin(self.point, self.clearance, self.normal, direction), direction)
    }
}

/// Half the spacing of numbers next to one in single precision: what one rounding moves, in parts.
const ROUNDING: f64 = MACHINE_EPSILON as f64;
/// Error of the place of an edge in the ray's space, relative to the triangle's extent.
const EDGE_ERROR: f64 = 16.0 * ROUNDING;
/// How near an edge must be for that to matter, relative to the triangle's extent.
const EDGE_REACH: f64 = 4.0 * EDGE_ERROR;
/// The same, in roundings of the point.
const EDGE_ROUNDINGS: f64 = 8.0;
/// How much of the way to its middle a point next to an edge is moved at most, over the least error of a weight: a
/// needle's point is not to be carried along the needle.
const MOST_INWARDS: f64 = 64.0;
/// Error of a point put together in double precision, relative to the triangle's extent.
const DOUBLE_ERROR: f64 = 16.0 * f64::EPSILON;
/// Error of an inverse matrix in double precision, of which each entry is a difference of two products over the
/// determinant; 72 roundings, made 128, by the sum over its entries and the matrix's.
const INVERSE_ERROR: f64 = 64.0 * f64::EPSILON;
/// For what is left out below, all of it products of two roundings.
const SECOND_ORDER: f64 = 1.0 + 1.0 / 64.0;

/// The point at barycentric coordinates of a triangle. Its corners are in object space; the transforms lead from
/// there to render space, outermost first, each from a child's space to its parent's.
///
/// The point is put together in double precision from one corner and two edges, so that rounded barycentrics move it
/// within the plane alone, and is rounded once, in render space. A ray from there is rounded again in the space of
/// each transform that is not the identity, as the hierarchy takes it inwards in double precision. What counts is how
/// far these roundings move it towards the plane: in each space, the product of the rounding, by components, with
/// the plane's normal there. The products add up, each over the length of the normal that it leads to. (pbrt-v4
/// section 6.8.4 brings boxes of error outwards instead: with those of matrices in single precision, and each turn
/// makes a box larger.)
///
/// A direction is not moved: one that lies in the plane but for its own rounding may be turned by that of the
/// transforms.
///
/// Next to an edge the test cannot tell on which neighbour a point is. There the ray must also clear the rounding of
/// where that edge is, which is relative to the triangle's extent: the point is moved twice that into the triangle, and
/// past what its own roundings move it, and is to be cleared by as much. How near an edge is is told by the weights,
/// which no transform changes.
#[inline]
pub fn surface_point<'a>(
    triangle: [Point3; 3],
    [b0, b1, b2]: [f32; 3],
    transforms: impl DoubleEndedIterator<Item = &'a DAffine3> + Clone,
) -> SurfacePoint {
    let transforms = transforms.filter(|t| **t != DAffine3::IDENTITY);
    let [a, b, c] = [triangle[0].0.as_dvec3(), triangle[1].0.as_dvec3(), triangle[2].0.as_dvec3()];
    let weights = [f64::from(b0), f64::from(b1), f64::from(b2)];
    let mut edges = [b - a, c - a];
    let mut point = a + edges[0] * weights[1] + edges[1] * weights[2];
    let extent = (a - point).abs().max((b - point).abs()).max((c - point).abs()).max_element();
    let mut normal = edges[0].cross(edges[1]);
    let own = point.abs() * ROUNDING;
    // Towards the plane, times the normal's length: of all roundings, and of where an edge is.
    let mut height = normal.abs().dot(own + DVec3::splat(extent * DOUBLE_ERROR));
    let mut edge_height = normal.abs().dot(DVec3::splat(extent * EDGE_ERROR));
    let mut most_reach = most_weight_error(edges, normal, own * EDGE_ROUNDINGS + DVec3::splat(extent * EDGE_REACH));
    for transform in transforms.clone().rev() {
        let matrix = &transform.matrix3;
        let volume = if *matrix == DMat3::IDENTITY {
            point += transform.translation;
            1.0
        } else {
            edges = [*matrix * edges[0], *matrix * edges[1]];
            point = transform.transform_point3(point);
            normal = edges[0].cross(edges[1]);
            // The normal was multiplied by the cofactors: lengths along it by the determinant.
            matrix.determinant().abs()
        };
        let own = point.abs() * ROUNDING;
        height = height * volume + normal.abs().dot(own + inverse_error(transform, volume, point));
        edge_height *= volume;
        most_reach += most_weight_error(edges, normal, own * EDGE_ROUNDINGS);
    }
    // Most points are far from all edges: these need no exact reach. What is not a number is near.
    let is_far = weights[0].min(weights[1]).min(weights[2]) >= most_reach;
    if !is_far {
        let reach = edge_reach([a, b, c], weights, extent, transforms);
        if weights[0] < reach.x || weights[1] < reach.y || weights[2] < reach.z {
            height += edge_height;
            let to_middle = edges[0] * (1.0 / 3.0 - weights[1]) + edges[1] * (1.0 / 3.0 - weights[2]);
            point += to_middle * inwards(weights, reach);
        }
    }
    let area = normal.length();
    let (unit, clearance) = if area > 0.0 { (normal / area, height / area * SECOND_ORDER) } else { (DVec3::ZERO, 0.0) };
    SurfacePoint { point: Point3(point.as_vec3()), normal: Normal3(unit.as_vec3()), clearance: clearance as f32 }
}

/// By how much each weight of a point may be off in the ray's space, at most.
#[cold]
fn edge_reach<'a>(
    [a, b, c]: [DVec3; 3],
    weights: [f64; 3],
    extent: f64,
    transforms: impl DoubleEndedIterator<Item = &'a DAffine3>,
) -> DVec3 {
    let mut edges = [b - a, c - a];
    let mut point = a + edges[0] * weights[1] + edges[1] * weights[2];
    let own = point.abs() * ROUNDING;
    let of = |edges: [DVec3; 2], half| weight_error(edges, edges[0].cross(edges[1]), half);
    let mut reach = of(edges, own * EDGE_ROUNDINGS + DVec3::splat(extent * EDGE_REACH));
    for transform in transforms.rev() {
        edges = edges.map(|e| transform.matrix3 * e);
        point = transform.transform_point3(point);
        reach += of(edges, point.abs() * ROUNDING * EDGE_ROUNDINGS);
    }
    reach
}

/// As much as the largest component of [`weight_error`], or more: by lengths in place of products.
#[inline]
fn most_weight_error([e1, e2]: [DVec3; 2], normal: DVec3, half: DVec3) -> f64 {
    let longest = e1.length_squared().max(e2.length_squared()).max((e2 - e1).length_squared());
    (longest * half.length_squared() / normal.length_squared()).sqrt() * SECOND_ORDER
}

/// By how much each weight is off where a point is off by a box of these half-widths, at most.
#[inline]
fn weight_error([e1, e2]: [DVec3; 2], normal: DVec3, half: DVec3) -> DVec3 {
    let across = |edge: DVec3| normal.cross(edge).abs().dot(half);
    let squared = normal.length_squared();
    let error = DVec3::new(across(e2 - e1), across(e2), across(e1)) / squared;
    if squared > 0.0 { error } else { DVec3::ZERO }
}

/// What part of the way to its middle brings a point of a triangle so far from each edge; for a needle, less.
#[cold]
fn inwards(weights: [f64; 3], reach: DVec3) -> f64 {
    const MIDDLE: f64 = 1.0 / 3.0;
    let lacking = weights.into_iter().zip(reach.to_array()).filter(|(weight, reach)| weight < reach);
    let part = lacking.map(|(weight, reach)| if reach < MIDDLE { (reach - weight) / (MIDDLE - weight) } else { 1.0 });
    part.fold(0.0, f64::max).min(MOST_INWARDS * reach.min_element()).min(1.0)
}

/// How far, in the parent's space, a point may be moved by the rounding of the inverse in double precision. It
/// matters where a matrix is all but singular: flattened and turned before and after.
#[inline]
fn inverse_error(t: &DAffine3, volume: f64, point: DVec3) -> DVec3 {
    let m = &t.matrix3;
    let largest = m.x_axis.abs().max(m.y_axis.abs()).max(m.z_axis.abs()).max_element();
    let reach = point.abs().max(t.translation.abs()).max_element();
    let cubed = largest * largest * largest;
    DVec3::splat(if volume > 0.0 { INVERSE_ERROR * cubed / volume * reach } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use umber_math::{Transform, Vec3};

    const TRIANGLE: [Point3; 3] =
        [Point3(Vec3::new(1.0, 2.0, 0.5)), Point3(Vec3::new(3.0, 2.5, -0.5)), Point3(Vec3::new(0.0, 4.0, 1.0))];

    fn transform() -> DAffine3 {
        let turn = DAffine3::from_rotation_x(0.7) * DAffine3::from_rotation_z(-1.9);
        DAffine3::from_translation(DVec3::new(1e4, -30.0, 7.0))
            * turn
            * DAffine3::from_scale(DVec3::new(-2.0, 1.0, 5.0))
    }

    #[test]
    fn point_and_normal_are_those_of_the_moved_triangle() {
        let m = transform();
        let at = surface_point(TRIANGLE, [0.25, 0.25, 0.5], [&m].into_iter());
        let [a, b, c] = TRIANGLE.map(|p| m.transform_point3(p.0.as_dvec3()));
        assert_eq!(at.point.0, (a * 0.25 + b * 0.25 + c * 0.5).as_vec3());
        let n = (b - a).cross(c - a).normalize();
        assert!(n.distance(at.normal.0.as_dvec3()) < 1e-7);
        let by_inverse =
            Transform::from_affine(m).unwrap().normal(crate::geometric_normal(TRIANGLE[0], TRIANGLE[1], TRIANGLE[2]));
        assert!(by_inverse.normalized().0.dot(at.normal.0) < -0.999, "mirrored, the winding names the other side");
    }

    #[test]
    fn clearance_is_a_few_spacings_of_the_coarsest_space() {
        // There and back: the space between is where the numbers are far apart.
        let far = DAffine3::from_translation(DVec3::splat(1e6));
        let back = DAffine3::from_translation(DVec3::splat(-1e6));
        let clearance = |t: &[&DAffine3]| surface_point(TRIANGLE, [0.3, 0.3, 0.4], t.iter().copied()).clearance;
        let spacing = 1e6f32.next_up() - 1e6;
        assert!(clearance(&[]) < 4.0 * f32::EPSILON);
        assert!(clearance(&[&DAffine3::IDENTITY]) == clearance(&[]));
        assert!((0.25 * spacing..2.0 * spacing).contains(&clearance(&[&far, &back])));
        assert!((0.25 * spacing..2.0 * spacing).contains(&clearance(&[&far])));
    }

    #[test]
    fn rays_leave_to_the_side_that_they_go_to() {
        let m = transform();
        let at = surface_point(TRIANGLE, [0.2, 0.3, 0.5], [&m].into_iter());
        let corner = m.transform_point3(TRIANGLE[0].0.as_dvec3());
        for side in [1.0, -1.0] {
            let ray = at.spawn_ray(at.normal.as_vector() * side);
            let height = (ray.origin.0.as_dvec3() - corner).dot(at.normal.0.as_dvec3()) * f64::from(side);
            assert!(height > 0.0 && height < 1e-2, "{height}");
        }
    }

    #[test]
    fn no_area_gives_no_normal_and_no_nan() {
        let p = TRIANGLE[0];
        let at = surface_point([p, p, p], [1.0, 0.0, 0.0], [&transform()].into_iter());
        assert_eq!(at.normal.0, Vec3::ZERO);
        assert!(at.point.0.is_finite() && at.clearance == 0.0);
    }
}
