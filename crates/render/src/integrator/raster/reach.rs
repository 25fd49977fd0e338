//! Where a box can be on the film, and how near.

use umber_math::{Bounds3, Point3, Vec3};

use super::project::{FilmFromObject, Grid, Homogeneous};

/// Where something can be.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// First and last column, first and last row.
    pub pixels: [[i32; 2]; 2],
    /// No less than its nearness anywhere.
    pub nearness: f32,
}

impl Grid {
    /// Where a box can be on the film, and how near at most; `None` where nothing of it can be seen.
    #[inline(always)]
    pub fn reach(&self, film_from_object: &FilmFromObject, bounds: Bounds3) -> Option<Reach> {
        let ends = [bounds.min, bounds.max];
        let (mut corners, mut around, mut is_in_front) = ([Homogeneous::default(); 8], Around::NOTHING, true);
        for i in 0..8 {
            let p = Point3(Vec3::new(ends[i & 1].x, ends[i >> 1 & 1].y, ends[i >> 2].z));
            corners[i] = film_from_object.apply(p);
            is_in_front &= corners[i].distance >= self.near && corners[i].distance <= f64::MAX;
        }
        if is_in_front {
            for p in &corners {
                around.add(self, p);
            }
        } else if self.misses(film_from_object, bounds) {
            return None;
        } else {
            self.part_in_front(&corners, &mut around);
        }
        around.reach(self)
    }

    /// Puts what lies beyond the near plane of a box into what is `around`.
    #[cold]
    fn part_in_front(&self, corners: &[Homogeneous; 8], around: &mut Around) {
        for (i, p) in corners.iter().enumerate() {
            if !(p.x.is_finite() && p.y.is_finite() && p.distance.is_finite()) {
                *around = Around::ALL;
            } else if p.distance >= self.near {
                around.add(self, p);
            } else {
                // three edges of the box end here
                for q in [1, 2, 4].map(|bit| &corners[i ^ bit]).into_iter().filter(|q| q.distance >= self.near) {
                    let t = (self.near - p.distance) / (q.distance - p.distance);
                    around.add(self, &Homogeneous { distance: self.near, ..p.toward(*q, t) });
                }
            }
        }
    }

    /// Whether nothing of a box can be on the film.
    pub fn misses(&self, film_from_object: &FilmFromObject, bounds: Bounds3) -> bool {
        let corners = bounds.corners().map(|p| film_from_object.apply(p));
        let [half_x, half_y] = [self.width, self.height].map(|pixels| 0.5 * f64::from(pixels));
        // a corner that is not a number is beyond nothing
        let all = |beyond: &dyn Fn(&Homogeneous) -> bool| corners.iter().all(beyond);
        all(&|p| p.distance < self.near)
            || all(&|p| p.distance > self.far)
            || all(&|p| p.x < -half_x * self.weight(p))
            || all(&|p| p.x > half_x * self.weight(p))
            || all(&|p| p.y < -half_y * self.weight(p))
            || all(&|p| p.y > half_y * self.weight(p))
    }
}

/// A rectangle on the film, from its middle, pixels, and the least distance of what is there.
struct Around {
    low: [f64; 2],
    high: [f64; 2],
    distance: f64,
}

impl Around {
    const NOTHING: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2], distance: f64::INFINITY };
    const ALL: Self = Self { low: [f64::NEG_INFINITY; 2], high: [f64::INFINITY; 2], distance: 0.0 };

    #[inline(always)]
    fn add(&mut self, grid: &Grid, p: &Homogeneous) {
        let scale = 1.0 / grid.weight(p);
        let (x, y) = (p.x * scale, p.y * scale);
        self.low = [less(self.low[0], x), less(self.low[1], y)];
        self.high = [-less(-self.high[0], -x), -less(-self.high[1], -y)];
        self.distance = less(self.distance, p.distance);
    }

    /// By a pixel more than it is, whatever the rounding.
    #[inline(always)]
    fn pixels(&self, axis: usize, pixels: i32) -> [i32; 2] {
        let half = 0.5 * f64::from(pixels);
        [((self.low[axis] + half - 1.0) as i32).max(0), ((self.high[axis] + half + 1.0) as i32).min(pixels - 1)]
    }

    #[inline(always)]
    fn reach(&self, grid: &Grid) -> Option<Reach> {
        let pixels = [self.pixels(0, grid.width), self.pixels(1, grid.height)];
        let nearness = if grid.is_perspective { 1.0 / self.distance } else { -self.distance } as f32;
        let nearness = nearness + nearness.abs() * 1e-5;
        let is_on_film = pixels[0][0] <= pixels[0][1] && pixels[1][0] <= pixels[1][1];
        (is_on_film && nearness > grid.far_nearness).then_some(Reach { pixels, nearness })
    }
}

/// The lesser of two numbers; the first where the second is none.
#[inline(always)]
fn less(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}
