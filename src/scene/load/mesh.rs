//! Reading of triangle meshes and of the transform of a shape.
//!
//! ```text
//! x ↦ M x + t      M u × M v = det(M) M⁻ᵀ (u × v)
//! ```
//!
//! A mirroring M (det M < 0) would turn the normal that follows from the winding away from the image of the front. Reversing
//! the winding of every face turns it back.

use super::cursor::{Cursor, LARGEST_LENGTH, SMALLEST_LENGTH};
use crate::scene::{SceneError, description::Geometry};
use glam::{DMat3, DVec2, DVec3};

/// Relative tolerance: edges whose angle has a smaller sine are parallel, and a triangle with a smaller ratio of height to
/// longest edge has no area.
pub(super) const FLAT: f64 = 1e-9;

/// Reads the geometry of a mesh.
pub(super) fn mesh(c: &Cursor) -> Result<Geometry, SceneError> {
    let points = c.require("vertices", "vertices = [[x, y, z], …]")?.items("an array of points")?;
    let mut vertices = points.iter().map(Cursor::vector).collect::<Result<Vec<_>, _>>()?;
    let list = c.require("faces", "faces = [[0, 1, 2], …]")?;
    let rows = list.items("an array of triangles")?;
    if rows.is_empty() {
        return Err(list.error("the mesh has no faces").help("add triangles such as [0, 1, 2]"));
    }
    let mut faces = rows.iter().map(|f| f.face(vertices.len())).collect::<Result<Vec<_>, _>>()?;
    if let Some((f, row)) = faces.iter().zip(&rows).find(|(f, _)| flat(f.map(|i| vertices[i as usize]))) {
        let e = row.error(format!("the triangle {f:?} has no area"));
        return Err(e.help("its three corners must not lie on one line"));
    }
    let mut uvs = uvs(c, vertices.len(), &faces)?;
    if let Some(t) = transform(c)? {
        t.apply(&mut vertices, &mut faces, &mut uvs)?;
    }
    Ok(Geometry::Mesh { vertices, faces, uvs })
}

/// The texture coordinates of the corners of each face, from the list `uvs` with one pair per vertex.
fn uvs(c: &Cursor, vertices: usize, faces: &[[u32; 3]]) -> Result<Vec<[DVec2; 3]>, SceneError> {
    let Some(list) = c.get("uvs") else { return Ok(Vec::new()) };
    let rows = list.items("an array of pairs")?;
    if rows.len() != vertices {
        let e = list.error(format!("the mesh has {} uvs for {vertices} vertices", rows.len()));
        return Err(e.help("write one pair [u, v] per vertex, with the origin at the bottom left of the image"));
    }
    let uvs = rows.iter().map(Cursor::uv).collect::<Result<Vec<_>, _>>()?;
    Ok(faces.iter().map(|f| f.map(|i| uvs[i as usize])).collect())
}

/// Returns true if the area of a triangle is zero or too small to compute with.
pub(super) fn flat([a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    longest < SMALLEST_LENGTH || (b - a).cross(c - a).length() <= FLAT * longest * longest
}

/// The affine map x ↦ M x + t.
pub(super) struct Transform<'a> {
    at: Cursor<'a>,
    linear: DMat3,
    shift: DVec3,
}

/// Reads the optional `transform` of a shape.
pub(super) fn transform<'a>(c: &Cursor<'a>) -> Result<Option<Transform<'a>>, SceneError> {
    let Some(at) = c.get("transform") else { return Ok(None) };
    let [x, y, z] = at.rows()?;
    let rows = [x.row()?, y.row()?, z.row()?];
    let linear = DMat3::from_cols_array_2d(&rows.map(|[a, b, c, _]| [a, b, c])).transpose();
    let scale = linear.x_axis.length() * linear.y_axis.length() * linear.z_axis.length();
    if linear.determinant().abs() <= FLAT * scale {
        let e = at.error("the transform flattens the shape, because its determinant is zero");
        return Err(e.help("write three rows [a, b, c, t] whose parts [a, b, c] are linearly independent"));
    }
    Ok(Some(Transform { at, linear, shift: DVec3::from(rows.map(|r| r[3])) }))
}

impl Transform<'_> {
    /// Transforms the vertices. If the transform mirrors, it also reverses the winding of every face, so that the front
    /// stays the image of the front.
    pub(super) fn apply(
        &self,
        vertices: &mut [DVec3],
        faces: &mut [[u32; 3]],
        uvs: &mut [[DVec2; 3]],
    ) -> Result<(), SceneError> {
        vertices.iter_mut().for_each(|v| *v = self.linear * *v + self.shift);
        if self.linear.determinant() < 0.0 {
            faces.iter_mut().for_each(|f| f.swap(1, 2));
            uvs.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let far = vertices.iter().any(|v| v.abs().max_element() > LARGEST_LENGTH);
        if far || faces.iter().any(|f| flat(f.map(|i| vertices[i as usize]))) {
            let e = self.at.error("the transform makes the shape too large or one of its triangles too thin");
            return Err(e.help("stay within 1e12 m, and scale all directions by similar factors"));
        }
        Ok(())
    }
}
