//! Scenes of any size: a ball of n triangles in a room, and n lamps over a floor.
//!
//! ```text
//! x(d) = 0.6 (1 + 0.1 sin 9d₁ sin 9d₂ sin 9d₃) d        d on an icosahedron, each face cut into f² triangles
//! ```
//!
//! The bumps give the ball triangles of every direction, and its own shadows. Corners that two faces of the icosahedron share are
//! computed by the same sums, so that they are equal to the last bit and the mesh is closed.

use glam::DVec3;
use std::io::{self, Write};

/// A room of 12 triangles with two lamps of two triangles each, and in it a ball of 20 f² triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// f, into how many parts every edge of the icosahedron is cut.
    pub frequency: u64,
}

/// Triangles of the walls and lamps.
const WALLS: u64 = 16;

/// Corners of the icosahedron, not of unit length.
const PHI: f64 = 1.618_033_988_749_895;
const CORNERS: [[f64; 3]; 12] = [
    [-1.0, PHI, 0.0],
    [1.0, PHI, 0.0],
    [-1.0, -PHI, 0.0],
    [1.0, -PHI, 0.0],
    [0.0, -1.0, PHI],
    [0.0, 1.0, PHI],
    [0.0, -1.0, -PHI],
    [0.0, 1.0, -PHI],
    [PHI, 0.0, -1.0],
    [PHI, 0.0, 1.0],
    [-PHI, 0.0, -1.0],
    [-PHI, 0.0, 1.0],
];
const FACES: [[usize; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

impl Room {
    /// The room with that many triangles; none if there is none.
    pub fn of(triangles: u64) -> Option<Self> {
        let frequency = (triangles.checked_sub(WALLS)? as f64 / 20.0).sqrt().round() as u64;
        Some(Self { frequency }).filter(|room| frequency > 0 && room.triangles() == triangles)
    }

    /// Its number of triangles.
    pub fn triangles(self) -> u64 {
        WALLS + 20 * self.frequency * self.frequency
    }

    /// Writes the room as OBJ; `mtl` is the name of a file that contains [`Room::materials`].
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(self, mtl: &str, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "mtllib {mtl}\no ball\nusemtl ball")?;
        let f = self.frequency;
        let mut before = 0;
        for face in FACES {
            let [a, b, c] = face.map(|i| DVec3::from(CORNERS[i]));
            // corner (i, j) is the j-th of row i
            let number = |i: u64, j: u64| before + i * (f + 1) - i * i.saturating_sub(1) / 2 + j + 1;
            for i in 0..=f {
                for j in 0..=f - i {
                    let p = bumpy(a * (f - i - j) as f64 + b * i as f64 + c * j as f64);
                    writeln!(out, "v {:.9} {:.9} {:.9}", p.x, p.y, p.z)?;
                }
            }
            for i in 0..f {
                for j in 0..f - i {
                    writeln!(out, "f {} {} {}", number(i, j), number(i + 1, j), number(i, j + 1))?;
                    if i + j + 1 < f {
                        writeln!(out, "f {} {} {}", number(i + 1, j), number(i + 1, j + 1), number(i, j + 1))?;
                    }
                }
            }
            before += (f + 1) * (f + 2) / 2;
        }
        writeln!(out, "o walls\nusemtl walls")?;
        for i in 0..8 {
            let side = |bit: u32| if i >> bit & 1 == 0 { -1 } else { 1 };
            writeln!(out, "v {} {} {}", side(0), side(1), side(2))?;
        }
        for [a, b, c, d] in [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]] {
            let [a, b, c, d] = [a, b, c, d].map(|i: u64| before + i);
            writeln!(out, "f {a} {b} {c}\nf {a} {c} {d}")?;
        }
        before += 8;
        writeln!(out, "o lamps\nusemtl lamps")?;
        for x in [-0.6, 0.2] {
            let [l, r] = [x, x + 0.4];
            writeln!(out, "v {l} 0.99 -0.2\nv {r} 0.99 -0.2\nv {r} 0.99 0.2\nv {l} 0.99 0.2")?;
            let n = before;
            writeln!(out, "f {} {} {}\nf {} {} {}", n + 1, n + 2, n + 3, n + 1, n + 3, n + 4)?;
            before += 4;
        }
        Ok(())
    }

    /// Its materials: the MTL file that its OBJ file names.
    pub fn materials() -> &'static str {
        "newmtl ball\nKd 0.5 0.5 0.5\nnewmtl walls\nKd 0.7 0.7 0.7\nnewmtl lamps\nKd 0 0 0\nKe 20 20 20\n"
    }
}

/// The point of the bumpy ball in direction `d`.
fn bumpy(d: DVec3) -> DVec3 {
    let d = d.normalize();
    let [x, y, z] = d.to_array().map(|x| (9.0 * x).sin());
    0.6 * (1.0 + 0.1 * x * y * z) * d
}

/// A scene file with `n` lamps over a floor. They are squares in a square grid of cells, and each fills a quarter of its cell; the
/// last row of cells may have gaps. All lamps have the same power, and all together 1 W.
pub fn lamps(n: u64) -> String {
    let side = (n as f64).sqrt().ceil() as u64;
    let (cell, power) = (2.0 / side as f64, 1.0 / n as f64);
    let mut text = String::from(
        "name = \"lamps\"\n\
         [camera]\norigin = [0, 0.8, 2.4]\ntarget = [0, 0, 0]\nup = [0, 1, 0]\nfov = 50\nsize = [64, 64]\n\
         [materials]\nfloor = { type = \"diffuse\", reflectance = [0.6, 0.6, 0.6] }\n\
         lamp = { type = \"diffuse\", reflectance = [0, 0, 0] }\n\
         [[shapes]]\ntype = \"quad\"\nmaterial = \"floor\"\norigin = [-2, 0, 2]\nedge_u = [4, 0, 0]\nedge_v = [0, 0, -4]\n",
    );
    for i in 0..n {
        let [x, z] = [i % side, i / side].map(|i| -1.0 + (i as f64 + 0.25) * cell);
        let edge = 0.5 * cell;
        text += &format!(
            "[[shapes]]\ntype = \"quad\"\nmaterial = \"lamp\"\norigin = [{x}, 1, {z}]\nedge_u = [{edge}, 0, 0]\n\
             edge_v = [0, 0, {edge}]\npower = [{power}, {power}, {power}]\n"
        );
    }
    text
}
