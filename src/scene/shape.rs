//! Intersection of a ray with a primitive: one formula per kind. All ways of tracing use the same formula and give the same
//! bits.
//!
//! The point `o + t·d` is on the surface, with `t > 0`.
//!
//! | kind | test | reference |
//! |---|---|---|
//! | [`Flat`] | plane, then |u|, |v| ≤ 1 in coordinates centred on the parallelogram; close to an edge, where rounding matters, the test of a triangle | – |
//! | [`Triangle`] | signs of the volumes between ray and edges; a shared edge has the same sign for both triangles, so meshes have no cracks | Plücker test in the robust form of Embree (Wald et al. 2014); Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection* (2013) |
//! | [`Ball`] | quadratic, in `f64` | – |
//! | [`Disc`] | plane, then distance from the centre | – |
//!
//! A hit is projected onto its surface, which moves it by no more than rounding ([`rounding`](super::rounding)). It is also
//! kept a few units in the last place inside the edges of its primitive. The next ray then starts inside a closed room and
//! cannot leave through a corner. If primitives share corners, the edge test leaves no gap between them, however narrow they
//! are. No primitive extends beyond its edges, because there it would catch rays that have just left its neighbour.

pub(crate) use super::ball::Ball;
pub(crate) use super::flat::Flat;
use super::plucker;
use super::primitive::Primitive;
pub(crate) use super::rounding::dot;
use super::rounding::{KEEP, MOST_KEEP, across, onto};
use glam::{DVec3, Vec3};

/// A hit: the distance `t` in units of the direction's length, and the number of the primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    pub(crate) t: f32,
    pub(crate) prim: u32,
}

impl Hit {
    pub(crate) const NONE: Self = Self { t: f32::INFINITY, prim: u32::MAX };

    /// Replaces this hit by `new` if that is nearer; of two at the same distance the one with the lower number is kept.
    #[inline(always)]
    pub(crate) fn take(&mut self, new: Self) {
        if new.t < self.t || (new.t == self.t && new.prim < self.prim) {
            *self = new;
        }
    }
}

#[inline(always)]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// A triangle with its corners and its plane `n·p = h`, ready for rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    pub(crate) p: [Vec3; 3],
    pub(crate) n: Vec3,
    pub(crate) h: f32,
    /// M (m) for the edge opposite to each corner.
    pub(super) keep: [f32; 3],
}

impl Triangle {
    fn new(p: [DVec3; 3]) -> Self {
        let twice = (p[1] - p[0]).cross(p[2] - p[0]);
        let n = twice.normalize();
        let keep = [0, 1, 2].map(|i| {
            let edge = p[(i + 2) % 3] - p[(i + 1) % 3];
            let height = twice.length() / edge.length();
            (KEEP * across(n.cross(edge).normalize(), &p)).min(0.5 * MOST_KEEP * height) as f32
        });
        // the plane passes through the centroid, so that no corner is preferred
        let h = n.dot((p[0] + p[1] + p[2]) / 3.0);
        Self { p: p.map(|p| p.as_vec3()), n: n.as_vec3(), h: h as f32, keep }
    }

    /// The numbers that [`Self::point`] uses: corners, plane.
    pub(crate) fn span(&self) -> [f32; Flat::SPAN] {
        let ([a, b, c], n) = (self.p, self.n);
        [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, n.x, n.y, n.z, self.h]
    }

    /// A triangle with these numbers.
    #[inline(always)]
    pub(crate) fn spanned(x: [f32; Flat::SPAN]) -> Self {
        let v = |i: usize| Vec3::new(x[i], x[i + 1], x[i + 2]);
        Self { p: [v(0), v(3), v(6)], n: v(9), h: x[12], keep: [0.0; 3] }
    }

    /// A uniformly distributed point, chosen by `u`.
    #[inline(always)]
    pub(crate) fn point(&self, u: [f32; 2]) -> Vec3 {
        let r = u[0].sqrt();
        let p = self.p[0] * (1.0 - r) + self.p[1] * (r * (1.0 - u[1])) + self.p[2] * (r * u[1]);
        onto(p, self.n, self.h)
    }

    #[inline(always)]
    pub(crate) fn meet(&self, o: Vec3, d: Vec3) -> (f32, bool) {
        let ([p, q, r], o, d) = (self.p, o.to_array(), d.to_array());
        let [u, v, w] = plucker::edges([p.to_array(), q.to_array(), r.to_array()], o, d);
        let same = ((u >= 0.0) & (v >= 0.0) & (w >= 0.0)) | ((u <= 0.0) & (v <= 0.0) & (w <= 0.0));
        // a triangle that rounding has reduced to a line or a point has no inside
        let some = (u != 0.0) | (v != 0.0) | (w != 0.0);
        let t = plucker::distance(self.n.to_array(), self.h, o, d);
        (t, same & some & (t > 0.0) & (t < f32::INFINITY))
    }

    /// Twice the signed areas of the triangles between the point `p` and the edge opposite to each corner.
    #[inline(always)]
    fn parts(&self, p: Vec3) -> [f32; 3] {
        let area = |a: Vec3, b: Vec3| dot(cross(a - p, b - p), self.n);
        [area(self.p[1], self.p[2]), area(self.p[2], self.p[0]), area(self.p[0], self.p[1])]
    }

    /// The point of the plane nearest to `p`, kept inside the edges.
    #[inline(always)]
    pub(crate) fn settle(&self, p: Vec3) -> Vec3 {
        let mut p = onto(p, self.n, self.h);
        for i in 0..3 {
            let (a, b) = (self.p[(i + 1) % 3], self.p[(i + 2) % 3]);
            let e = b - a;
            let (part, length2) = (dot(cross(e, p - a), self.n), dot(e, e));
            // part/length is the distance from the edge
            if part < 0.0 || part * part < self.keep[i] * self.keep[i] * length2 {
                let length = length2.sqrt();
                p += cross(self.n, e) * ((self.keep[i] - part / length) / length);
            }
        }
        p
    }
}

/// A flat disk with its plane `n·p = h`, ready for rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    center: Vec3,
    n: Vec3,
    h: f32,
    radius: f32,
}

impl Disc {
    /// The plane: its normal and its distance from the origin.
    pub(crate) fn plane(&self) -> (Vec3, f32) {
        (self.n, self.h)
    }

    #[inline(always)]
    pub(crate) fn meet(&self, o: Vec3, d: Vec3) -> (f32, bool) {
        let t = (self.h - dot(self.n, o)) / dot(self.n, d);
        let f = o + d * t - self.center;
        (t, (t > 0.0) & (dot(f, f) <= self.radius * self.radius))
    }
}

/// A primitive, ready for rays. Parallelograms and spheres need more memory than triangles. They are stored by reference, so that a
/// mesh of millions of triangles does not pay for them.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Flat(Box<Flat>),
    Triangle(Triangle),
    Ball(Box<Ball>),
    Disc(Disc),
}

impl Shape {
    /// Prepares a primitive for rays. `touch` is the largest difference of two corners that are meant to be the same, m.
    pub(crate) fn new(p: &Primitive, touch: f64) -> Self {
        match *p {
            Primitive::Parallelogram { origin, edge_u, edge_v } => {
                Self::Flat(Box::new(Flat::new(origin, edge_u, edge_v, touch)))
            }
            Primitive::Triangle(p) => Self::Triangle(Triangle::new(p)),
            Primitive::Sphere { center, radius, z, inward } => {
                Self::Ball(Box::new(Ball::new(center, radius, z, inward)))
            }
            Primitive::Disk { center, normal, radius } => Self::Disc(Disc {
                center: center.as_vec3(),
                n: normal.as_vec3(),
                h: normal.dot(center) as f32,
                radius: radius as f32,
            }),
        }
    }

    #[inline(always)]
    pub(crate) fn meet(&self, o: Vec3, d: Vec3) -> (f32, bool) {
        match self {
            Self::Flat(s) => s.meet(o, d),
            Self::Triangle(s) => s.meet(o, d),
            Self::Ball(s) => s.meet(o, d),
            Self::Disc(s) => s.meet(o, d),
        }
    }

    /// The point of the surface nearest to a computed hit, kept inside the edges.
    #[inline(always)]
    pub(crate) fn settle(&self, p: Vec3) -> Vec3 {
        match self {
            Self::Flat(s) => s.settle(p),
            Self::Triangle(s) => s.settle(p),
            Self::Ball(s) => s.settle(p),
            Self::Disc(s) => onto(p, s.n, s.h),
        }
    }

    /// Coordinates of a point of the surface: u, v along the edges of a parallelogram, or the barycentric weights of a
    /// triangle's corners.
    pub(crate) fn coordinates(&self, p: Vec3) -> [f32; 3] {
        match self {
            Self::Flat(s) => {
                [0.5 * (s.sure[0] * (dot(s.a, p) + s.a0) + 1.0), 0.5 * (s.sure[1] * (dot(s.b, p) + s.b0) + 1.0), 0.0]
            }
            Self::Triangle(s) => {
                let w = s.parts(p);
                w.map(|x| x / (w[0] + w[1] + w[2]))
            }
            Self::Ball(_) | Self::Disc(_) => [0.0; 3],
        }
    }

    /// Unit normal of the front at a point of the surface.
    #[inline(always)]
    pub(crate) fn normal(&self, p: Vec3) -> Vec3 {
        match self {
            Self::Flat(s) => s.n,
            Self::Triangle(s) => s.n,
            Self::Ball(s) => s.normal(p),
            Self::Disc(s) => s.n,
        }
    }

    /// A uniformly distributed point of the surface, chosen by `u`.
    #[inline(always)]
    pub(crate) fn point(&self, u: [f32; 2]) -> Vec3 {
        match self {
            Self::Flat(s) => s.point(u),
            Self::Triangle(s) => s.point(u),
            Self::Ball(s) => s.point(u),
            Self::Disc(s) => {
                let r = s.radius * u[0].sqrt();
                let (c, sn) = crate::math::direction::cos_sin_turn(u[1]);
                onto(s.center + crate::math::direction::about(s.n, r * c, r * sn, 0.0), s.n, s.h)
            }
        }
    }
}
