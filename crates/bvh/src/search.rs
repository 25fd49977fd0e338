//! What a search has found so far.

use crate::path::InstancePath;

/// A ray's hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Parameter along the ray, in the units of its direction.
    pub t: f32,
    /// Weights of the triangle's vertices.
    pub barycentrics: [f32; 3],
    /// The mesh, as the caller numbered it.
    pub mesh: u32,
    /// The triangle of that mesh.
    pub triangle: u32,
    /// The instances that the ray went through, outermost first.
    pub path: InstancePath,
}

/// A closest-hit search.
pub(crate) struct Search {
    /// Hits up to and with this parameter are wanted.
    pub limit: f32,
    /// The best so far, at `limit`.
    pub best: Option<Hit>,
    /// Where the search is.
    pub path: InstancePath,
}

impl Search {
    /// For hits before `t_max`.
    pub fn new(t_max: f32) -> Self {
        Self { limit: t_max.next_down(), best: None, path: InstancePath::default() }
    }

    /// Takes a hit if it is closer than the best, or at the same `t` and first by path and triangle.
    #[inline]
    pub fn offer(&mut self, t: f32, barycentrics: [f32; 3], mesh: u32, triangle: u32) {
        let wins = match &self.best {
            None => t <= self.limit,
            Some(best) => {
                t < self.limit
                    || t == self.limit && (self.path.as_slice(), triangle) < (best.path.as_slice(), best.triangle)
            }
        };
        if wins {
            self.limit = t;
            self.best = Some(Hit { t, barycentrics, mesh, triangle, path: self.path });
        }
    }
}
