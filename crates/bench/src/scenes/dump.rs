//! Triangles dumped from USD stages by `dump_triangles.py`.
//!
//! All little-endian: `UMBERTRI`, number of points and of triangles (u32), the camera's position,
//! a point before it and the width of its picture at distance one (7 × f32), the points (3 × f32 each) and the triangles (3 × u32 each), in the world.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};
use umber_math::{Point3, Vec3};

use super::{Mesh, Scene};

const MAGIC: &[u8] = b"UMBERTRI";
const HEADER: usize = 44;

/// The dumps in a folder, by name; none where the folder is not there.
pub fn read_all(folder: &Path) -> Result<Vec<Scene>> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(Vec::new()) };
    let mut files: Vec<_> = entries.flatten().map(|e| e.path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "tri"));
    files.sort();
    files.iter().map(|f| read(f).with_context(|| f.display().to_string())).collect()
}

fn read(file: &Path) -> Result<Scene> {
    let bytes = fs::read(file)?;
    ensure!(bytes.len() >= HEADER && bytes.starts_with(MAGIC), "no dump of triangles");
    let words: Vec<u32> =
        bytes[MAGIC.len()..].chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect();
    let (points, triangles) = (words[0] as usize, words[1] as usize);
    let header = (HEADER - MAGIC.len()) / 4;
    ensure!(words.len() == header + 3 * (points + triangles), "cut short");
    let vector = |w: &[u32]| Vec3::new(f32::from_bits(w[0]), f32::from_bits(w[1]), f32::from_bits(w[2]));
    let (positions, indices) = words[header..].split_at(3 * points);
    let mesh = Mesh {
        points: positions.chunks_exact(3).map(|w| Point3(vector(w))).collect(),
        triangles: indices.chunks_exact(3).map(|w| [w[0], w[1], w[2]]).collect(),
    };
    let name = file.file_stem().unwrap_or_default().to_string_lossy().replace('_', " ");
    let scene = Scene::flat(&name, mesh, vector(&words[2..]), vector(&words[5..]));
    Ok(Scene { width: f32::from_bits(words[8]), ..scene })
}
