//! Which wheel carries which OpenUSD.

use super::Manifest;

/// One version of OpenUSD and the wheel that carries it.
#[derive(Debug)]
pub struct Version {
    /// Version of OpenUSD, as its tags have it.
    pub usd: &'static str,
    /// Version of the wheel `bpy`.
    pub bpy: &'static str,
    /// Version of Python that the wheel is built for.
    pub python: &'static str,
}

/// All that can be assembled, newest first.
pub const TABLE: [Version; 2] =
    [Version { usd: "25.08", bpy: "5.0.1", python: "3.11" }, Version { usd: "25.02", bpy: "4.5.15", python: "3.11" }];

/// The row of `text`, for the command line.
///
/// # Errors
/// No wheel carries that version; the ones there are are named.
pub fn parse(text: &str) -> Result<&'static Version, String> {
    let known = TABLE.map(|version| version.usd).join(", ");
    TABLE.iter().find(|version| version.usd == text).ok_or_else(|| format!("known versions: {known}"))
}

impl Version {
    /// Year (less 2000) and month of the release.
    pub fn numbers(&self) -> (u32, u32) {
        let (year, month) = self.usd.split_once('.').unwrap_or((self.usd, "0"));
        (year.parse().unwrap_or(0), month.parse().unwrap_or(0))
    }

    /// Blender's own version, as its folders have it: major and minor.
    pub fn blender(&self) -> &'static str {
        self.bpy.rsplit_once('.').map_or(self.bpy, |(minor, _)| minor)
    }

    /// The namespace that Blender builds OpenUSD in.
    pub fn internal_namespace(&self) -> String {
        format!("pxrBlender_v{}", self.usd.replace('.', "_"))
    }

    /// What an SDK of this version is made from.
    pub fn manifest(&self) -> Manifest {
        Manifest { usd: self.usd.into(), bpy: self.bpy.into(), python: self.python.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_from_the_version() {
        let version = parse("25.08").unwrap();
        assert_eq!(version.numbers(), (25, 8));
        assert_eq!(version.blender(), "5.0");
        assert_eq!(version.internal_namespace(), "pxrBlender_v25_08");
        assert!(parse("19.11").unwrap_err().contains("25.08"));
    }

    #[test]
    fn newest_comes_first() {
        assert!(TABLE.is_sorted_by_key(|version| std::cmp::Reverse(version.numbers())));
    }
}
