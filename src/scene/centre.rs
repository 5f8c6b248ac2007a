//! A scene about a point in its middle, so that single precision is spent on the scene and not on where it stands.
//!
//! ```text
//! x' = (x − a) − c        a: the least coordinates of the scene's points        c: the middle of what is left
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x | a point in the coordinates of the file, `f64` | [`Description`] |
//! | x' | the same for rays and patches | [`Scene`](super::Scene), [`Patches`](crate::operator::patches::Patches) |
//! | a + c | where x' = 0 lies in the file | [`Centred::origin`] |
//! | η | how far rounding x' to `f32` moves a point of a shape, over the shape's least height | [`Coarse`] |
//!
//! Both differences are taken point by point: a scene moved by a vector that `f64` holds exactly has the same x', bit for bit. Where
//! the middle of the scene would round some shape by more than 10⁻⁶ of its height, c is the middle of that shape: a lamp of 2 cm
//! keeps its size beside a ground of 20 km.
//!
//! Corners of meshes that differ by no more than the rounding of the file's own coordinates become one, coordinate by
//! coordinate, so that triangles of different shapes that share an edge share it to the last bit.

use super::description::{Description, Geometry, LightDescription};
use super::rounding::EPSILON;
use glam::DVec3;

/// A scene about its middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Centred {
    /// The scene; its points are relative to [`Self::origin`].
    pub scene: Description,
    /// The middle, in the coordinates of the file.
    pub origin: DVec3,
    /// By how much two corners that are meant to be one may differ, m: the rounding of the file's coordinates.
    pub touch: f64,
}

/// A shape that single precision rounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coarse {
    /// Its number.
    pub shape: usize,
    /// How far a point of it moves, m.
    pub moved: f64,
    /// Its least height, m.
    pub height: f64,
}

impl Coarse {
    /// η.
    pub fn share(&self) -> f64 {
        self.moved / self.height
    }
}

/// A shape is refused where rounding moves one of its points by more than this part of its least height.
pub const TOO_COARSE: f64 = 1e-4;
/// Up to this share the middle of the scene will do.
const FINE: f64 = 1e-6;

impl Description {
    /// The scene about its middle.
    ///
    /// ```
    /// use fredholm::scene::load;
    /// let furnace = load::scene("furnace", &load::Options::default())?.description;
    /// let centred = furnace.centred();
    /// assert_eq!(centred.origin, glam::DVec3::ZERO); // its box runs from −1 to 1
    /// assert_eq!(centred.scene.shapes, furnace.shapes);
    /// # Ok::<(), fredholm::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn centred(&self) -> Centred {
        let points = || self.shapes.iter().flat_map(|s| s.geometry.points());
        let least = points().fold(DVec3::INFINITY, DVec3::min);
        let least = if least.is_finite() { least } else { DVec3::ZERO };
        let farthest = points().fold(0.0f64, |m, p| m.max(p.abs().max_element()));
        let mut scene = self.clone();
        scene.shift(least);

        let middle = scene.middle();
        let mut origin = middle;
        if let Some(worst) = scene.coarsest(middle).filter(|w| w.share() > FINE) {
            let other = scene.shapes[worst.shape].geometry.middle();
            let better = scene.coarsest(other).is_none_or(|o| o.share() < worst.share());
            origin = if better { other } else { middle };
        }
        scene.shift(origin);
        let touch = 4.0 * f64::EPSILON * farthest;
        scene.weld(touch);
        Centred { scene, origin: least + origin, touch }
    }

    /// The shape that `f32` coordinates about `origin` round most, relative to its height.
    pub fn coarsest(&self, origin: DVec3) -> Option<Coarse> {
        let all = self.shapes.iter().enumerate().map(|(shape, s)| {
            let (moved, height) = s.geometry.rounding(origin);
            Coarse { shape, moved, height }
        });
        all.max_by(|a, b| a.share().total_cmp(&b.share()))
    }

    fn middle(&self) -> DVec3 {
        middle(self.shapes.iter().flat_map(|s| s.geometry.primitives()).map(|p| p.bounds()))
    }

    fn shift(&mut self, by: DVec3) {
        self.shapes.iter_mut().for_each(|s| s.geometry.shift(by));
        self.camera.origin -= by;
        self.camera.target -= by;
        for light in &mut self.lights {
            if let LightDescription::Point { position, .. } = light {
                *position -= by;
            }
        }
    }

    /// Coordinates of mesh corners that differ by no more than `touch` become equal.
    fn weld(&mut self, touch: f64) {
        for axis in 0..3 {
            let mut all: Vec<&mut f64> = vec![];
            for shape in &mut self.shapes {
                if let Geometry::Mesh { vertices, .. } = &mut shape.geometry {
                    all.extend(vertices.iter_mut().map(|v| &mut v.as_mut()[axis]));
                }
            }
            all.sort_unstable_by(|a, b| a.total_cmp(b));
            let mut first = f64::NEG_INFINITY;
            for x in all {
                if *x - first > touch {
                    first = *x;
                }
                *x = first;
            }
        }
    }
}

fn middle(bounds: impl Iterator<Item = [DVec3; 2]>) -> DVec3 {
    let [low, high] = bounds.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    if low.is_finite() && high.is_finite() { 0.5 * (low + high) } else { DVec3::ZERO }
}

impl Geometry {
    /// The points that a file gives for it.
    fn points(&self) -> Vec<DVec3> {
        match self {
            Self::Mesh { vertices, faces, .. } => faces.iter().flatten().map(|i| vertices[*i as usize]).collect(),
            Self::Quad { origin, .. } => vec![*origin],
            Self::Box { min, max, .. } => vec![*min, *max],
            Self::Sphere { center, .. } | Self::Disk { center, .. } => vec![*center],
        }
    }

    fn middle(&self) -> DVec3 {
        middle(self.primitives().iter().map(super::Primitive::bounds))
    }

    fn shift(&mut self, by: DVec3) {
        match self {
            Self::Mesh { vertices, .. } => vertices.iter_mut().for_each(|v| *v -= by),
            Self::Quad { origin, .. } => *origin -= by,
            Self::Box { min, max, .. } => {
                *min -= by;
                *max -= by;
            }
            Self::Sphere { center, .. } | Self::Disk { center, .. } => *center -= by,
        }
    }

    /// How far `f32` coordinates about `origin` move a point of it, and its least height, m. The height of a mesh is its area over
    /// its diameter: that of a needle is the needle's.
    fn rounding(&self, origin: DVec3) -> (f64, f64) {
        let corner = |p: DVec3| (p - origin - (p - origin).as_vec3().as_dvec3()).length();
        let corners = |points: &[DVec3]| points.iter().map(|p| corner(*p)).fold(0.0, f64::max);
        match self {
            Self::Mesh { .. } => {
                let primitives = self.primitives();
                let [low, high] = primitives
                    .iter()
                    .map(|p| p.bounds())
                    .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
                let area: f64 = primitives.iter().map(super::Primitive::area).sum();
                (corners(&self.points()), area / (high - low).length())
            }
            &Self::Quad { origin: o, edge_u: u, edge_v: v } => {
                (corners(&[o, o + u, o + v, o + u + v]), u.cross(v).length() / u.length().max(v.length()))
            }
            Self::Box { min, max, .. } => {
                let corners =
                    self.primitives().iter().flat_map(super::Primitive::bounds).map(corner).fold(0.0, f64::max);
                (corners, (*max - *min).min_element())
            }
            // its points are anywhere on it
            Self::Sphere { center, radius, .. } => {
                (EPSILON * ((*center - origin).abs().max_element() + radius), 2.0 * radius)
            }
            Self::Disk { center, radius, .. } => (corner(*center), 2.0 * radius),
        }
    }
}
