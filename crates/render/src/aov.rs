//! The table of AOVs: every picture that a render can give beside or instead of colour.

use crate::BufferFormat;

/// An AOV, by its row in [`TABLE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Aov {
    /// Radiance and coverage.
    Color,
    /// Depth as the projection has it, 0 near to 1 far.
    Depth,
    /// Distance along the view axis.
    CameraDepth,
    /// Shading normal, world space.
    Normal,
    /// Shading normal, camera space.
    Neye,
    /// Id of the prim.
    PrimId,
    /// Number of the instance within its prim.
    InstanceId,
    /// Face of the mesh.
    ElementId,
    /// Texture coordinates.
    St,
}

/// How samples add up to a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accumulation {
    /// The mean of all samples.
    Mean,
    /// What is seen through the middle of the pixel.
    Center,
}

/// One row of the table.
#[derive(Clone, Copy, Debug)]
pub struct AovRow {
    /// The AOV.
    pub aov: Aov,
    /// Hydra's token.
    pub name: &'static str,
    /// Format of a buffer, where the host names none.
    pub format: BufferFormat,
    /// Value where nothing is seen, in each component.
    pub clear: f32,
    /// How samples add up.
    pub accumulation: Accumulation,
}

/// All AOVs.
pub const TABLE: [AovRow; 9] = {
    use Accumulation::{Center, Mean};
    use BufferFormat::{Float32, Float32Vec3, Float32Vec4, Int32};
    const fn row(aov: Aov, name: &'static str, format: BufferFormat, clear: f32, accumulation: Accumulation) -> AovRow {
        AovRow { aov, name, format, clear, accumulation }
    }
    [
        row(Aov::Color, "color", Float32Vec4, 0.0, Mean),
        row(Aov::Depth, "depth", Float32, 1.0, Center),
        row(Aov::CameraDepth, "cameraDepth", Float32, 0.0, Center),
        row(Aov::Normal, "normal", Float32Vec3, 0.0, Center),
        row(Aov::Neye, "Neye", Float32Vec3, 0.0, Center),
        row(Aov::PrimId, "primId", Int32, -1.0, Center),
        row(Aov::InstanceId, "instanceId", Int32, -1.0, Center),
        row(Aov::ElementId, "elementId", Int32, -1.0, Center),
        row(Aov::St, "primvars:st", Float32Vec3, 0.0, Center),
    ]
};

impl Aov {
    /// This AOV's row.
    pub fn row(self) -> &'static AovRow {
        &TABLE[self as usize]
    }
    /// The AOV with this token.
    pub fn from_name(name: &str) -> Option<Self> {
        TABLE.iter().find(|row| row.name == name).map(|row| row.aov)
    }
    /// Hydra's token.
    pub fn name(self) -> &'static str {
        self.row().name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_where_their_aov_says() {
        for (i, row) in TABLE.iter().enumerate() {
            assert_eq!(row.aov as usize, i);
            assert_eq!(Aov::from_name(row.name), Some(row.aov));
        }
        assert_eq!(Aov::from_name("beauty"), None);
    }
}
