//! What can be wrong with a mesh, said once per kind.

use thiserror::Error;

use crate::Interpolation;

/// A defect of a mesh. Where faces are concerned, those are left out and all others kept.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MeshProblem {
    /// Faces of fewer than three corners.
    #[error("{faces} faces skipped: fewer than 3 corners (first: face {first_face})")]
    TooFewCorners {
        /// How many faces.
        faces: usize,
        /// The first of them.
        first_face: usize,
    },
    /// Faces with a negative number of corners; taken as having none.
    #[error("{faces} faces skipped: corner count {count} is negative (first: face {first_face})")]
    NegativeCount {
        /// How many faces.
        faces: usize,
        /// The first of them.
        first_face: usize,
        /// Its number of corners.
        count: i32,
    },
    /// Faces whose corners lie past the end of the indices.
    #[error("{faces} faces skipped: corners needed up to {needed}, {indices} indices given (first: face {first_face})")]
    CountsPastIndices {
        /// How many faces.
        faces: usize,
        /// The first of them.
        first_face: usize,
        /// Number of indices that the counts up to and with this face ask for.
        needed: usize,
        /// Number of indices there are.
        indices: usize,
    },
    /// Faces with a corner that names no point.
    #[error("{faces} faces skipped: corner index {index} is beyond the {points} points (first: face {first_face})")]
    IndexOutOfRange {
        /// How many faces.
        faces: usize,
        /// The first of them.
        first_face: usize,
        /// Its first corner that is out of range.
        index: i32,
        /// Number of points.
        points: usize,
    },
    /// Faces with a point that has a NaN or infinite coordinate.
    #[error("{faces} faces skipped: point {point} is not finite (first: face {first_face})")]
    NonFinitePoint {
        /// How many faces.
        faces: usize,
        /// The first of them.
        first_face: usize,
        /// Its first point that is not finite.
        point: usize,
    },
    /// Faces without area.
    #[error("{faces} faces skipped: their area is zero (first: face {first_face})")]
    ZeroArea {
        /// How many faces.
        faces: usize,
        /// The first of them.
        first_face: usize,
    },
    /// Indices that belong to no face.
    #[error("{left} indices left over after the last face, which ends at {used}")]
    LeftoverIndices {
        /// How many indices are left.
        left: usize,
        /// How many the faces use.
        used: usize,
    },
    /// Hole indices that name no face.
    #[error("{holes} hole indices ignored: face {index} is beyond the {faces} faces")]
    HoleOutOfRange {
        /// How many hole indices.
        holes: usize,
        /// The first of them.
        index: i32,
        /// Number of faces.
        faces: usize,
    },
    /// A primvar with fewer values than its interpolation asks for.
    #[error("{given} values given where {interpolation:?} interpolation needs {needed}")]
    AttributeTooShort {
        /// How the values spread.
        interpolation: Interpolation,
        /// Number of values needed.
        needed: usize,
        /// Number of values given.
        given: usize,
    },
}
