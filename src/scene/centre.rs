//! A scene in coordinates about its middle, so that single precision resolves the scene well wherever it lies in the file's
//! coordinates.
//!
//! ```text
//! x' = (x − a) − c        a: the smallest coordinates of the scene's points        c: the middle after subtraction of a
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x | a point in the coordinates of the file, `f64` | [`Description`] |
//! | x' | the same point in the coordinates of rays and patches | [`Scene`](super::Scene), [`Patches`](crate::operator::patches::Patches) |
//! | a + c | position of x' = 0 in the coordinates of the file | [`Centred::origin`] |
//! | η | largest movement of a point of a shape when x' is rounded to `f32`, divided by the shape's smallest height | [`Coarse`] |
//!
//! Both differences are computed point by point. So a scene that is moved by a vector which `f64` holds exactly has the same
//! x', bit for bit. If x' about the middle of the scene would give some shape an η above 10⁻⁶, c is the middle of that
//! shape, provided this reduces the largest η. A lamp of 2 cm then keeps its size next to a ground of 20 km.
//!
//! Corners of meshes that differ by no more than the rounding of the file's coordinates are made equal, coordinate by
//! coordinate. Triangles of different shapes that share an edge then share it to the last bit.

use super::description::{Description, Geometry, LightDescription};
use super::rounding::EPSILON;
use glam::DVec3;

/// A scene in coordinates about its middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Centred {
    /// The scene; all its points are relative to [`Self::origin`].
    pub scene: Description,
    /// The middle of the scene, in the coordinates of the file, m.
    pub origin: DVec3,
    /// Largest difference of two corners that are meant to be the same, m: the rounding of the file's coordinates.
    pub touch: f64,
}

/// Effect of rounding to single precision on one shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coarse {
    /// Index of the shape.
    pub shape: usize,
    /// Largest distance by which a point of the shape moves, m.
    pub moved: f64,
    /// Smallest height of the shape, m.
    pub height: f64,
}

impl Coarse {
    /// η: movement divided by height.
    pub fn share(&self) -> f64 {
        self.moved / self.height
    }
}

/// Largest η of an accepted shape; the loader refuses a shape with a larger one.
pub const TOO_COARSE: f64 = 1e-4;
/// Largest η at which the middle of the scene is used as the origin.
const FINE: f64 = 1e-6;

impl Description {
    /// The scene in coordinates about its middle.
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

    /// The shape with the largest η for `f32` coordinates about `origin`; `None` if there are no shapes.
    pub fn coarsest(&self, origin: DVec3) -> Option<Coarse> {
        let all = self.shapes.iter().enumerate().map(|(shape, s)| {
            let (moved, height) = s.geometry.rounding(origin);
            Coarse { shape, moved, height }
        });
        all.max_by(|a, b| a.share().total_cmp(&b.share()))
    }

    fn middle(&self) -> DVec3 {
        middle(self.shapes.iter().flat_map(|s| s.geometry.each()).map(|p| p.bounds()))
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

    /// Makes coordinates of mesh corners equal if they differ by no more than `touch`.
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
    /// The points that a file gives for this geometry.
    fn points(&self) -> impl Iterator<Item = DVec3> + '_ {
        let (vertices, faces, few): (&[DVec3], &[[u32; 3]], Vec<DVec3>) = match self {
            Self::Mesh { vertices, faces, .. } => (vertices, faces, vec![]),
            Self::Quad { origin, .. } => (&[], &[], vec![*origin]),
            Self::Box { min, max, .. } => (&[], &[], vec![*min, *max]),
            Self::Sphere { center, .. } | Self::Disk { center, .. } => (&[], &[], vec![*center]),
        };
        faces.iter().flatten().map(move |i| vertices[*i as usize]).chain(few)
    }

    fn middle(&self) -> DVec3 {
        middle(self.each().map(|p| p.bounds()))
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

    /// The largest distance by which `f32` coordinates about `origin` move a point of this geometry, and its smallest
    /// height, both in m. The height of a mesh is its area divided by its diameter, which for a needle is the width of the
    /// needle.
    fn rounding(&self, origin: DVec3) -> (f64, f64) {
        let corner = |p: DVec3| (p - origin - (p - origin).as_vec3().as_dvec3()).length();
        let corners = |points: &mut dyn Iterator<Item = DVec3>| points.map(corner).fold(0.0, f64::max);
        match self {
            Self::Mesh { .. } => {
                let [low, high] = self
                    .each()
                    .map(|p| p.bounds())
                    .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
                let area: f64 = self.each().map(|p| p.area()).sum();
                (corners(&mut self.points()), area / (high - low).length())
            }
            &Self::Quad { origin: o, edge_u: u, edge_v: v } => (
                corners(&mut [o, o + u, o + v, o + u + v].into_iter()),
                u.cross(v).length() / u.length().max(v.length()),
            ),
            Self::Box { min, max, .. } => {
                let corners = self.each().flat_map(|p| p.bounds()).map(corner).fold(0.0, f64::max);
                (corners, (*max - *min).min_element())
            }
            // any point of the sphere may be used, so a bound replaces the exact rounding
            Self::Sphere { center, radius, .. } => {
                (EPSILON * ((*center - origin).abs().max_element() + radius), 2.0 * radius)
            }
            Self::Disk { center, radius, .. } => (corner(*center), 2.0 * radius),
        }
    }
}
