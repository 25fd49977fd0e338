//! Sample sequences, warps, distributions and MIS weights.
