//! The numbers by which triangles are seen, batch by batch: few bits a pixel, however many triangles there are.

use std::ops::Range;

use super::placement::Placement;
use super::visibility::NOTHING;
use crate::scene::RenderScene;

/// Points that are projected at a time, at most, but for those of one mesh: what bounds the memory. Few in
/// tests, so that they have several batches.
const MOST_POINTS: usize = if cfg!(test) { 64 } else { 1 << 22 };
/// Triangles that are drawn at a time, at most, but for those of one mesh.
const MOST_TRIANGLES: u32 = 1 << 30;

/// What is seen: a triangle of a placement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Index of the placement.
    pub placement: u32,
    /// Triangle of its mesh.
    pub triangle: u32,
}

/// Placements that are drawn together.
#[derive(Debug)]
pub struct Batch {
    /// Indices of the placements.
    pub placements: Range<usize>,
    /// The number of the first triangle of each.
    first_numbers: Vec<u32>,
}

impl Batch {
    /// All placements in batches.
    pub fn all(scene: &RenderScene, placements: &[Placement]) -> Vec<Self> {
        let (mut batches, mut batch, mut points, mut number) = (Vec::new(), Self::from(0), 0, NOTHING + 1);
        for (i, placement) in placements.iter().enumerate() {
            let shape = &placement.mesh(scene).shape;
            if points > 0 && (points + shape.points.len() > MOST_POINTS || number > MOST_TRIANGLES) {
                batches.push(std::mem::replace(&mut batch, Self::from(i)));
                (points, number) = (0, NOTHING + 1);
            }
            batch.placements.end = i + 1;
            batch.first_numbers.push(number);
            points += shape.points.len();
            // a mesh has less than 2^28 triangles that rays can meet
            number += shape.mesh.len() as u32;
        }
        batches.push(batch);
        batches
    }

    fn from(start: usize) -> Self {
        Self { placements: start..start, first_numbers: Vec::new() }
    }

    /// Number of the first triangle of placement `index`.
    pub fn first_number(&self, index: usize) -> u32 {
        self.first_numbers[index - self.placements.start]
    }

    /// What has a number; `None` for that of nothing.
    pub fn seen(&self, number: u32) -> Option<Seen> {
        let after = self.first_numbers.partition_point(|first| *first <= number);
        let index = after.checked_sub(1)?;
        let placement = (self.placements.start + index) as u32;
        Some(Seen { placement, triangle: number - self.first_numbers[index] })
    }
}
