//! Triangulation of one concave face by clipping ears.
//!
//! Meisters 1975, "Polygons Have Ears". Collinear corners are kept, unlike in libraries made for
//! maps: dropping one would leave a T-junction with the neighbouring face, and a crack.

use glam::{DVec2, DVec3};

/// Newell's normal of a polygon: twice its area along its mean plane's normal.
pub(crate) fn newell_normal(p: &[DVec3]) -> DVec3 {
    let origin = p[0];
    let edges = p.iter().zip(p.iter().cycle().skip(1));
    edges.fold(DVec3::ZERO, |n, (a, b)| n + (*a - origin).cross(*b - origin))
}

/// Twice the area of a triangle, along its normal.
pub(crate) fn cross_of([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Splits a polygon of `n` corners into `n − 2` triangles, seen along `normal`.
///
/// Where it crosses itself and no ear is left, the next corner is clipped all the same.
pub(crate) fn clip_ears(p: &[DVec3], normal: DVec3, out: &mut Vec<[u32; 3]>) {
    let flat = project(p, normal);
    let mut left: Vec<u32> = (0..p.len() as u32).collect();
    let mut at = 0;
    while left.len() > 3 {
        let n = left.len();
        let candidates = (0..n).map(|k| (at + k) % n);
        let ear = best_ear(&flat, &left, candidates).unwrap_or(at % n);
        out.push([left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]]);
        left.remove(ear);
        // Going on at the other side of the clipped corner keeps the triangles from fanning into slivers.
        at = if ear < left.len() { ear + 1 } else { 0 };
    }
    out.push([left[0], left[1], left[2]]);
}

/// The first ear with area; else the first without; `None` where there is neither.
fn best_ear(flat: &[DVec2], left: &[u32], candidates: impl Iterator<Item = usize>) -> Option<usize> {
    let mut without_area = None;
    for i in candidates {
        match ear_area(flat, left, i) {
            Some(area) if area > 0.0 => return Some(i),
            Some(_) if without_area.is_none() => without_area = Some(i),
            _ => {}
        }
    }
    without_area
}

/// Twice the area of the ear at corner `i`; `None` where that corner is no ear.
fn ear_area(flat: &[DVec2], left: &[u32], i: usize) -> Option<f64> {
    let n = left.len();
    let corners = [left[(i + n - 1) % n], left[i], left[(i + 1) % n]];
    let [a, b, c] = corners.map(|k| flat[k as usize]);
    let area = (b - a).perp_dot(c - a);
    if area < 0.0 {
        return None;
    }
    let inside = |q: DVec2| {
        let distinct = q != a && q != b && q != c;
        distinct
            && (b - a).perp_dot(q - a) >= 0.0
            && (c - b).perp_dot(q - b) >= 0.0
            && (a - c).perp_dot(q - c) >= 0.0
            && (area > 0.0 || (q - a).dot(q - c) <= 0.0)
    };
    let blocked = left.iter().any(|k| !corners.contains(k) && inside(flat[*k as usize]));
    (!blocked).then_some(area)
}

/// Drops the axis along which the normal is longest, keeping the winding counter-clockwise.
fn project(p: &[DVec3], normal: DVec3) -> Vec<DVec2> {
    let n = normal.abs();
    let origin = p[0];
    let axes = |q: &DVec3| {
        let q = *q - origin;
        if n.x >= n.y && n.x >= n.z {
            (normal.x, DVec2::new(q.y, q.z))
        } else if n.y >= n.z {
            (normal.y, DVec2::new(q.z, q.x))
        } else {
            (normal.z, DVec2::new(q.x, q.y))
        }
    };
    p.iter()
        .map(|q| {
            let (sign, flat) = axes(q);
            if sign < 0.0 { DVec2::new(flat.y, flat.x) } else { flat }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area_of(p: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|t| cross_of(t.map(|i| p[i as usize])).z / 2.0).sum()
    }

    #[test]
    fn comb_is_covered_once_and_without_overlap() {
        let mut p = vec![DVec3::new(0.0, -1.0, 0.0), DVec3::new(20.0, -1.0, 0.0)];
        p.extend((0..=20).rev().map(|i| DVec3::new(i as f64, if i % 2 == 0 { 3.0 } else { 0.0 }, 0.0)));
        let mut out = Vec::new();
        clip_ears(&p, newell_normal(&p), &mut out);
        assert_eq!(out.len(), p.len() - 2);
        assert!(out.iter().all(|t| cross_of(t.map(|i| p[i as usize])).z >= 0.0), "a triangle is turned over");
        assert!((area_of(&p, &out) - newell_normal(&p).z / 2.0).abs() < 1e-9);
    }

    #[test]
    fn collinear_corners_are_kept() {
        // An L with extra corners along its straight sides.
        let xy = [(0., 0.), (1., 0.), (2., 0.), (2., 1.), (1.5, 1.), (1., 1.), (1., 1.5), (1., 2.), (0., 2.), (0., 1.)];
        let p: Vec<DVec3> = xy.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
        let mut out = Vec::new();
        clip_ears(&p, newell_normal(&p), &mut out);
        assert_eq!(out.len(), 8);
        assert!((0..10).all(|i| out.iter().any(|t| t.contains(&i))), "a corner was dropped: {out:?}");
        assert!((area_of(&p, &out) - 3.0).abs() < 1e-12);
        assert!(out.iter().all(|t| cross_of(t.map(|i| p[i as usize])).z >= 0.0));
    }

    #[test]
    fn self_crossing_polygon_ends_with_every_triangle() {
        let p: Vec<DVec3> = (0..7)
            .map(|i| f64::from(i * 3) / 7.0 * std::f64::consts::TAU)
            .map(|a| DVec3::new(a.cos(), a.sin(), 0.0))
            .collect();
        let mut out = Vec::new();
        clip_ears(&p, newell_normal(&p), &mut out);
        assert_eq!(out.len(), 5);
    }
}
