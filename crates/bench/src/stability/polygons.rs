//! Polygons on a screen, as textbooks draw them: the odd-even rule for each, those with the larger mean depth first.
//!
//! The method that fails: a polygon has one depth here, wherever it is. Beside it the same with a depth at each pixel.

use umber_math::{DVec2, DVec3};

/// Index of no polygon.
pub const NONE: i32 = -1;

/// A square screen on z = 0, seen from an eye at (0, 0, `eye`).
#[derive(Clone, Copy, Debug)]
pub struct Screen {
    /// Height of the eye.
    pub eye: f64,
    /// Half the screen's edge.
    pub half: f64,
    /// Samples across and down.
    pub size: usize,
}

impl Screen {
    /// The position of a sample: the grid starts on the screen's corner at the top left.
    pub fn sample(&self, column: usize, row: usize) -> DVec2 {
        let step = 2.0 * self.half / self.size as f64;
        DVec2::new(column as f64 * step - self.half, self.half - row as f64 * step)
    }
    /// Where a point is on the screen.
    fn project(&self, p: DVec3) -> DVec2 {
        p.truncate() * (self.eye / (self.eye - p.z))
    }

    /// The polygon at each sample by the odd-even rule; `order` gives the depth that counts there, the largest first.
    fn faces(&self, faces: &[Vec<DVec3>], depth: impl Fn(usize, DVec2) -> f64) -> Vec<i32> {
        let projected: Vec<Vec<DVec2>> = faces.iter().map(|f| f.iter().map(|p| self.project(*p)).collect()).collect();
        let at = |i: usize| {
            let sample = self.sample(i % self.size, i / self.size);
            let covering = (0..faces.len()).filter(|f| is_inside(&projected[*f], sample));
            let nearest = covering.min_by(|a, b| depth(*a, sample).total_cmp(&depth(*b, sample)));
            nearest.map_or(NONE, |f| f as i32)
        };
        (0..self.size * self.size).map(at).collect()
    }

    /// By the mean of each polygon's depths: fails.
    pub fn by_mean_depth(&self, faces: &[Vec<DVec3>]) -> Vec<i32> {
        let distance = |p: &DVec3| (*p - DVec3::new(0.0, 0.0, self.eye)).length();
        let means: Vec<f64> = faces.iter().map(|f| f.iter().map(distance).sum::<f64>() / f.len() as f64).collect();
        self.faces(faces, |face, _| means[face])
    }

    /// By the depth at each sample.
    pub fn by_depth_at_sample(&self, faces: &[Vec<DVec3>]) -> Vec<i32> {
        let eye = DVec3::new(0.0, 0.0, self.eye);
        self.faces(faces, |face, sample| {
            let [a, b, c] = [faces[face][0], faces[face][1], faces[face][2]];
            let normal = (b - a).cross(c - a);
            let toward = sample.extend(0.0) - eye;
            (a - eye).dot(normal) / toward.dot(normal)
        })
    }

    /// Whether a sample lies on an edge of a polygon, as far as rounding tells.
    pub fn is_on_edge(&self, face: &[DVec3], column: usize, row: usize) -> bool {
        let sample = self.sample(column, row);
        let corners: Vec<DVec2> = face.iter().map(|p| self.project(*p)).collect();
        (0..corners.len()).any(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            (b - a).perp_dot(sample - a).abs() < 1e-6 * (b - a).length()
        })
    }
}

/// Whether a ray to the right from a position crosses the outline an odd number of times.
fn is_inside(corners: &[DVec2], at: DVec2) -> bool {
    let mut inside = false;
    for i in 0..corners.len() {
        let (a, b) = (corners[i], corners[(i + corners.len() - 1) % corners.len()]);
        if (a.y > at.y) != (b.y > at.y) && at.x < (b.x - a.x) * (at.y - a.y) / (b.y - a.y) + a.x {
            inside = !inside;
        }
    }
    inside
}
