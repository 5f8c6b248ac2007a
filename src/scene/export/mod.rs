//! A scene as a file for another renderer, so that its pictures can be compared with ours.
//!
//! ```text
//! shape u·edge_u + v·edge_v + origin   →   to_world of a unit square, or triangles        radiance, albedo   →   rgb
//! ```
//!
//! | renderer | place |
//! |---|---|
//! | Mitsuba 3: XML, meshes in OBJ files beside it | [`mitsuba`] |
//! | pbrt-v4: one file | [`pbrt`] |
//!
//! Geometry is written as it is described, in double precision. What has no counterpart in the other renderer is an error that names it;
//! what differs slightly is a note.

pub mod mitsuba;
pub mod pbrt;

use super::bsdf::colour::Colour;
use super::description::{Description, Geometry, Ggx, Masking, Material, Shape};
use glam::DVec3;

/// A renderer whose files can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renderer {
    /// Mitsuba 3.
    Mitsuba,
    /// pbrt-v4.
    Pbrt,
}

/// What a file needs in addition to the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Largest number of reflections; all light if `None`.
    pub max_bounces: Option<usize>,
    /// Samples per pixel.
    pub spp: u32,
    /// Name of the file without folder and ending: the beginning of the names of files beside it.
    pub stem: String,
}

/// A scene for another renderer.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// The content of the file.
    pub text: String,
    /// Files that must lie beside it: name and content.
    pub beside: Vec<(String, String)>,
    /// What differs slightly in the other renderer.
    pub notes: Vec<String>,
}

/// Something without a counterpart in the other renderer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsupported {
    /// What it is, and in which material, shape or light.
    pub what: String,
    /// What to do.
    pub help: String,
}

impl Unsupported {
    fn new(what: impl Into<String>, help: impl Into<String>) -> Self {
        Self { what: what.into(), help: help.into() }
    }
}

/// Writes a scene for another renderer.
///
/// ```
/// use fredholm::scene::export::{Renderer, Settings, export};
/// use fredholm::scene::load;
/// let cornell = load::scene("cornell", &load::Options::default())?.description;
/// let settings = Settings { max_bounces: None, spp: 64, stem: "cornell".into() };
/// let file = export(&cornell, Renderer::Mitsuba, &settings).unwrap();
/// assert!(file.text.contains(r#"<sensor type="perspective">"#));
/// assert_eq!(file.beside.len(), 2); // the two blocks are meshes
/// # Ok::<(), fredholm::scene::SceneError>(())
/// ```
///
/// # Errors
/// If a part of the scene has no counterpart in the other renderer.
pub fn export(d: &Description, to: Renderer, settings: &Settings) -> Result<Exported, Unsupported> {
    match to {
        Renderer::Mitsuba => mitsuba::export(d, settings),
        Renderer::Pbrt => pbrt::export(d, settings),
    }
}

/// The colour of a surface of one colour.
fn uniform(colour: &Colour, material: &Material) -> Result<DVec3, Unsupported> {
    match colour {
        Colour::Uniform(rgb) => Ok(*rgb),
        Colour::Texture(_) => Err(Unsupported::new(
            format!("the texture of material `{}`", material.name),
            "give it one colour: --set materials.NAME.reflectance=[r,g,b]",
        )),
    }
}

/// α of microfacets whose masking the other renderer has.
fn alpha(rough: &Ggx, has: Masking, material: &Material) -> Result<f64, Unsupported> {
    if rough.masking == has {
        return Ok(rough.alpha);
    }
    let (ours, theirs, word) = match has {
        Masking::Separable => ("height-correlated", "separable", "separable"),
        Masking::HeightCorrelated => ("separable", "height-correlated", "height-correlated"),
    };
    let name = &material.name;
    Err(Unsupported::new(
        format!("the {ours} masking of material `{name}`: the other renderer has {theirs} masking"),
        format!("use the same here and there: --set materials.{name}.masking=\"{word}\""),
    ))
}

/// Corners of a parallelogram: its origin, and counter-clockwise from there.
fn corners(origin: DVec3, edge_u: DVec3, edge_v: DVec3) -> [DVec3; 4] {
    [origin, origin + edge_u, origin + edge_u + edge_v, origin + edge_v]
}

/// Vertices and triangles of a shape that is flat or a mesh; `None` for curved shapes.
fn triangles(geometry: &Geometry) -> Option<(Vec<DVec3>, Vec<[u32; 3]>)> {
    match geometry {
        Geometry::Mesh { vertices, faces, .. } => Some((vertices.clone(), faces.clone())),
        Geometry::Quad { origin, edge_u, edge_v } => {
            Some((corners(*origin, *edge_u, *edge_v).to_vec(), vec![[0, 1, 2], [0, 2, 3]]))
        }
        Geometry::Box { min, max, rotate_y, inward } => Some(cuboid(*min, *max, *rotate_y, *inward)),
        Geometry::Sphere { .. } | Geometry::Disk { .. } => None,
    }
}

/// The twelve triangles of a box.
fn cuboid(min: DVec3, max: DVec3, rotate_y: f64, inward: bool) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let centre = 0.5 * (min + max);
    let (sin, cos) = rotate_y.to_radians().sin_cos();
    let corner = |i: usize| {
        let pick = |axis: usize| if i >> axis & 1 == 1 { max[axis] } else { min[axis] };
        let p = DVec3::new(pick(0), pick(1), pick(2)) - centre;
        centre + DVec3::new(cos * p.x + sin * p.z, p.y, cos * p.z - sin * p.x)
    };
    // the four corners of each face, counter-clockwise from outside; bit 0, 1, 2 of a corner: x, y, z at the maximum
    const FACES: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let turned = |t: [u32; 3]| if inward { [t[0], t[2], t[1]] } else { t };
    let faces = FACES.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).map(turned).collect();
    ((0..8).map(corner).collect(), faces)
}

/// Where a shape is, for messages.
fn named(i: usize, shape: &Shape) -> String {
    format!("shape {i} (`{}`)", shape.name)
}

/// Three numbers with blanks between them.
fn words(v: DVec3) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_the_normals_and_the_area_of_a_box() {
        for inward in [false, true] {
            let (min, max) = (DVec3::new(-1.0, 0.0, 2.0), DVec3::new(1.0, 3.0, 2.5));
            let (vertices, faces) = cuboid(min, max, 30.0, inward);
            let centre = 0.5 * (min + max);
            let mut area = 0.0;
            for f in faces {
                let [a, b, c] = f.map(|i| vertices[i as usize]);
                let normal = (b - a).cross(c - a);
                area += 0.5 * normal.length();
                assert_eq!(normal.dot(a - centre) > 0.0, !inward);
            }
            assert!((area - 2.0 * (2.0 * 3.0 + 3.0 * 0.5 + 2.0 * 0.5)).abs() < 1e-12);
        }
    }
}
