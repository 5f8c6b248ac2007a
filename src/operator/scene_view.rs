//! Connections of a scene's states to its camera: the pixel that sees a state, its importance, and whether anything is between.
//!
//! ```text
//! W = p_ω/r²          p = p_ω cos θ/r²          p_ω: density per solid angle with which the paths of a pixel take a direction
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | W | importance of a state with distance r, without the cosine at the state | [`Seen::importance`] |
//! | p | density per area with which a path starts at the state; θ is the angle at the state | [`Seen::density`] |
//! | p_ω | the inverse of the solid angle of the pixel | `Camera::pixel` |
//!
//! For the sky, r² and the cosine are left out. Directions are computed in `f64`, because the camera may be far away.

use super::scene_transport::SceneTransport;
use super::transport::Seen;
use crate::scene::{Camera, ESCAPED, Vertex, VertexWave, segment};
use glam::{DVec3, Vec3};

impl Camera {
    /// The vector from the pinhole to a state, in `f64`; for the sky, a unit direction.
    #[inline(always)]
    fn toward(&self, t: &SceneTransport, at: &Vertex) -> DVec3 {
        if t.parallel(at) { -at.omega.as_dvec3() } else { at.p.as_dvec3() - self.origin }
    }

    /// The pixel that sees a state if nothing blocks the view.
    #[inline(always)]
    pub(crate) fn see(&self, t: &SceneTransport, at: &Vertex) -> Option<Seen<Vertex>> {
        // a camera never sees a point light or a direction light
        if !at.on_surface() && at.side != ESCAPED {
            return None;
        }
        let d = self.toward(t, at);
        let (pixel, per_angle) = self.pixel(d)?;
        let pixel = pixel?;
        let r2 = if at.on_surface() { d.length_squared() as f32 } else { 1.0 };
        Some(Seen { pixel, eye: self.eye(), importance: per_angle / r2, density: per_angle * angle(at, d) })
    }

    #[inline(always)]
    fn eye(&self) -> Vertex {
        Vertex { p: self.origin.as_vec3(), n: Vec3::ZERO, ..Vertex::default() }
    }

    /// Density with which a path starts at a state that some pixel sees. It is also valid if rounding puts the state just
    /// outside the picture.
    pub(crate) fn start_density(&self, t: &SceneTransport, at: &Vertex) -> f32 {
        let d = self.toward(t, at);
        self.pixel(d).map_or(0.0, |(_, per_angle)| per_angle * angle(at, d))
    }

    /// The segment from a state to the eye: its ends with their normals.
    #[inline(always)]
    fn view(&self, t: &SceneTransport, at: &Vertex) -> (Vec3, Vec3, Vec3, Vec3) {
        let start = self.enter(self.toward(t, at).normalize());
        let (p, n) = if at.on_surface() {
            let toward_eye = if at.n.dot(start - at.p) < 0.0 { -at.n } else { at.n };
            (at.p, toward_eye)
        } else {
            (t.scene.beyond(start, -at.omega), Vec3::ZERO)
        };
        (p, n, start, Vec3::ZERO)
    }

    /// Returns true if nothing blocks the view from the eye to the state.
    pub(crate) fn unhidden(&self, t: &SceneTransport, at: &Vertex) -> bool {
        let (p, n, q, m) = self.view(t, at);
        !t.scene.blocked(p, n, q, m)
    }

    /// Keeps the states of the list that nothing hides from the eye.
    pub(crate) fn all_unhidden(&self, t: &SceneTransport, wave: &mut VertexWave, list: &mut Vec<u32>) {
        for (j, &i) in list.iter().enumerate() {
            let (p, n, q, m) = self.view(t, &wave.get(i as usize));
            let (o, d) = segment(p, n, q, m);
            wave.rays.o.set(i as usize, o);
            wave.rays.d.set(i as usize, d);
            wave.rays.list[j] = i;
        }
        t.scene.block_wave(&mut wave.rays, list.len());
        list.retain(|&i| wave.rays.prim[i as usize] == 0);
    }
}

/// Solid angle at the eye per unit of the measure of a state in direction `d` from the eye; 0 for a light that no ray can
/// hit.
#[inline(always)]
fn angle(at: &Vertex, d: DVec3) -> f32 {
    match at.side {
        ESCAPED => 1.0,
        _ if at.on_surface() => {
            let r2 = d.length_squared();
            (at.n.as_dvec3().dot(d).abs() / (r2 * r2.sqrt())) as f32
        }
        _ => 0.0,
    }
}
