//! What measures and tests share: cases where ray tracing methods fail, counted, and numbers that look random.

pub mod random;
pub mod stability;
