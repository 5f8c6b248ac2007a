//! Where a ray meets a primitive: one formula per kind, used by every engine with the same bits.
//!
//! `o + t·d` is on the surface, `t > 0`.
//!
//! | kind | test | reference |
//! |---|---|---|
//! | [`Flat`] | plane, then |u|, |v| ≤ 1 in coordinates centred on the parallelogram | – |
//! | [`Triangle`] | signs of edge·direction volumes; the sign of a shared edge is the same from both sides, so meshes have no cracks | Plücker test in the robust form of Embree (Wald et al. 2014) |
//! | [`Ball`] | quadratic with the discriminant from the foot of the perpendicular | Hearn and Baker; Haines et al., *Ray Tracing Gems* ch. 7 (2019) |
//! | [`Disc`] | plane, then distance from the centre | – |
//!
//! A hit point is computed anew on the surface and kept a hair (`margin`) inside the edge of its primitive, so that the
//! next ray starts inside a closed room and cannot slip out through a corner. Parallelograms reach the same hair over their
//! edges, for the same reason. `margin` and the offset of the next ray are fractions of the scene's size: a scene scaled
//! by a power of two gives the same bits.

use super::primitive::Primitive;
use glam::{DVec3, Vec3};

/// A hit: distance in units of the direction's length, and the two surface coordinates where the kind needs them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    pub(crate) t: f32,
    pub(crate) prim: u32,
}

impl Hit {
    pub(crate) const NONE: Self = Self { t: f32::INFINITY, prim: u32::MAX };
}

#[inline(always)]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[inline(always)]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// A parallelogram, ready for rays: plane `n·p = h`; `a·p + a0` and `b·p + b0` run from −1 to 1 across it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flat {
    pub(crate) n: Vec3,
    pub(crate) h: f32,
    pub(crate) a: Vec3,
    pub(crate) a0: f32,
    pub(crate) b: Vec3,
    pub(crate) b0: f32,
    /// 1 + margin, in these coordinates
    pub(crate) reach: [f32; 2],
    center: Vec3,
    half_u: Vec3,
    half_v: Vec3,
    /// 1 − margin
    keep: [f32; 2],
}

impl Flat {
    fn new(origin: DVec3, u: DVec3, v: DVec3, margin: f64) -> Self {
        let g = u.cross(v);
        let (gg, n) = (g.length_squared(), g.normalize());
        let (a, b) = (2.0 * v.cross(g) / gg, 2.0 * g.cross(u) / gg);
        let over = [2.0 * margin / u.length(), 2.0 * margin / v.length()].map(|m| m.min(0.25) as f32);
        let f = |v: DVec3| v.as_vec3();
        Self {
            n: f(n),
            h: n.dot(origin) as f32,
            a: f(a),
            a0: (-1.0 - a.dot(origin)) as f32,
            b: f(b),
            b0: (-1.0 - b.dot(origin)) as f32,
            reach: over.map(|m| 1.0 + m),
            center: f(origin + 0.5 * (u + v)),
            half_u: f(0.5 * u),
            half_v: f(0.5 * v),
            keep: over.map(|m| 1.0 - m),
        }
    }

    /// Distance, and whether the ray meets the parallelogram there. Also used lane by lane in packets.
    #[inline(always)]
    pub(crate) fn meet(&self, o: Vec3, d: Vec3) -> (f32, bool) {
        let t = (self.h - dot(self.n, o)) / dot(self.n, d);
        let p = Vec3::new(d.x * t + o.x, d.y * t + o.y, d.z * t + o.z);
        let (u, v) = (dot(self.a, p) + self.a0, dot(self.b, p) + self.b0);
        (t, (u.abs() <= self.reach[0]) & (v.abs() <= self.reach[1]) & (t > 0.0))
    }

    /// The point of the surface nearest to `p`, a margin inside the edges.
    #[inline(always)]
    pub(crate) fn settle(&self, p: Vec3) -> Vec3 {
        let clamp = |x: f32, m: f32| {
            if x > m {
                m
            } else if x < -m {
                -m
            } else {
                x
            }
        };
        let u = clamp(dot(self.a, p) + self.a0, self.keep[0]);
        let v = clamp(dot(self.b, p) + self.b0, self.keep[1]);
        self.center + self.half_u * u + self.half_v * v
    }
}

/// A triangle by its corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    p: [Vec3; 3],
    n: Vec3,
    /// Least barycentric coordinate of a settled point.
    keep: f32,
}

impl Triangle {
    fn new(p: [DVec3; 3], margin: f64) -> Self {
        let n = (p[1] - p[0]).cross(p[2] - p[0]);
        let longest = (p[1] - p[0]).length().max((p[2] - p[1]).length()).max((p[0] - p[2]).length());
        let height = n.length() / longest;
        Self { p: p.map(|p| p.as_vec3()), n: n.normalize().as_vec3(), keep: (margin / height).min(0.1) as f32 }
    }

    #[inline(always)]
    fn volumes(&self, o: Vec3, d: Vec3) -> (Vec3, [Vec3; 3]) {
        let v = self.p.map(|p| p - o);
        let edge = |a: Vec3, b: Vec3| dot(cross(a - b, a + b), d);
        (Vec3::new(edge(v[2], v[1]), edge(v[0], v[2]), edge(v[1], v[0])), v)
    }

    #[inline(always)]
    pub(crate) fn meet(&self, o: Vec3, d: Vec3) -> (f32, bool) {
        let (w, v) = self.volumes(o, d);
        let same = ((w.x >= 0.0) & (w.y >= 0.0) & (w.z >= 0.0)) | ((w.x <= 0.0) & (w.y <= 0.0) & (w.z <= 0.0));
        let t = dot(v[0], self.n) / dot(self.n, d);
        (t, same & (t > 0.0) & (t < f32::INFINITY))
    }

    /// Barycentric coordinates by areas about the normal, not yet divided by their sum.
    #[inline(always)]
    fn parts(&self, p: Vec3) -> [f32; 3] {
        let area = |a: Vec3, b: Vec3| dot(cross(a - p, b - p), self.n);
        [area(self.p[1], self.p[2]), area(self.p[2], self.p[0]), area(self.p[0], self.p[1])]
    }

    #[inline(always)]
    pub(crate) fn settle(&self, p: Vec3) -> Vec3 {
        // lifted to at least `keep`
        let w = self.parts(p);
        let total = w[0] + w[1] + w[2];
        let lift = |x: f32| if x / total > self.keep { x / total } else { self.keep };
        let w = w.map(lift);
        let sum = w[0] + w[1] + w[2];
        (self.p[0] * w[0] + self.p[1] * w[1] + self.p[2] * w[2]) * (1.0 / sum)
    }
}

/// A band of a sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    center: Vec3,
    radius: f32,
    z: [f32; 2],
    /// +1 outwards, −1 inwards
    sign: f32,
}

impl Ball {
    #[inline(always)]
    pub(crate) fn meet(&self, o: Vec3, d: Vec3) -> (f32, bool) {
        let f = o - self.center;
        let a = dot(d, d);
        let b = -dot(f, d);
        let foot = f + d * (b / a);
        let disc = self.radius * self.radius - dot(foot, foot);
        if disc < 0.0 {
            return (f32::INFINITY, false);
        }
        let c = dot(f, f) - self.radius * self.radius;
        let q = b + (a * disc).sqrt().copysign(b);
        let (t0, t1) = (c / q, q / a);
        let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
        let on_band = |t: f32| {
            let z = (f.z + d.z * t) / self.radius;
            t > 0.0 && z >= self.z[0] && z <= self.z[1]
        };
        if on_band(near) { (near, true) } else { (far, on_band(far)) }
    }

    #[inline(always)]
    fn settle(&self, p: Vec3) -> Vec3 {
        let f = p - self.center;
        self.center + f * (self.radius / dot(f, f).sqrt())
    }

    #[inline(always)]
    fn normal(&self, p: Vec3) -> Vec3 {
        (p - self.center) * (self.sign / self.radius)
    }
}

/// A flat disk.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    center: Vec3,
    n: Vec3,
    radius: f32,
}

impl Disc {
    #[inline(always)]
    fn meet(&self, o: Vec3, d: Vec3) -> (f32, bool) {
        let t = dot(self.n, self.center - o) / dot(self.n, d);
        let f = o + d * t - self.center;
        (t, (t > 0.0) & (dot(f, f) <= self.radius * self.radius))
    }

    #[inline(always)]
    fn settle(&self, p: Vec3) -> Vec3 {
        p - self.n * dot(self.n, p - self.center)
    }
}

/// A primitive, ready for rays.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shape {
    Flat(Flat),
    Triangle(Triangle),
    Ball(Ball),
    Disc(Disc),
}

impl Shape {
    pub(crate) fn new(p: &Primitive, margin: f64) -> Self {
        match *p {
            Primitive::Parallelogram { origin, edge_u, edge_v } => {
                Self::Flat(Flat::new(origin, edge_u, edge_v, margin))
            }
            Primitive::Triangle(p) => Self::Triangle(Triangle::new(p, margin)),
            Primitive::Sphere { center, radius, z, inward } => Self::Ball(Ball {
                center: center.as_vec3(),
                radius: radius as f32,
                // the poles are kept whatever the rounding
                z: [if z[0] <= -1.0 { -2.0 } else { z[0] as f32 }, if z[1] >= 1.0 { 2.0 } else { z[1] as f32 }],
                sign: if inward { -1.0 } else { 1.0 },
            }),
            Primitive::Disk { center, normal, radius } => {
                Self::Disc(Disc { center: center.as_vec3(), n: normal.as_vec3(), radius: radius as f32 })
            }
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

    /// The point of the surface nearest to a computed hit, a margin inside the edges.
    #[inline(always)]
    pub(crate) fn settle(&self, p: Vec3) -> Vec3 {
        match self {
            Self::Flat(s) => s.settle(p),
            Self::Triangle(s) => s.settle(p),
            Self::Ball(s) => s.settle(p),
            Self::Disc(s) => s.settle(p),
        }
    }

    /// Where a point of the surface lies: u, v along the edges of a parallelogram, the weights of a triangle's corners.
    pub(crate) fn coordinates(&self, p: Vec3) -> [f32; 3] {
        match self {
            Self::Flat(s) => [0.5 * (dot(s.a, p) + s.a0 + 1.0), 0.5 * (dot(s.b, p) + s.b0 + 1.0), 0.0],
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

    /// A uniformly distributed point.
    #[inline(always)]
    pub(crate) fn point(&self, u: [f32; 2]) -> Vec3 {
        match self {
            Self::Flat(s) => s.center + s.half_u * (2.0 * u[0] - 1.0) + s.half_v * (2.0 * u[1] - 1.0),
            Self::Triangle(s) => {
                let r = u[0].sqrt();
                s.p[0] * (1.0 - r) + s.p[1] * (r * (1.0 - u[1])) + s.p[2] * (r * u[1])
            }
            Self::Ball(s) => {
                let (lo, hi) = (s.z[0].max(-1.0), s.z[1].min(1.0));
                let z = lo + (hi - lo) * u[0];
                let r = (1.0 - z * z).max(0.0).sqrt();
                let (c, sn) = crate::math::direction::cos_sin_turn(u[1]);
                s.center + Vec3::new(r * c, r * sn, z) * s.radius
            }
            Self::Disc(s) => {
                let r = s.radius * u[0].sqrt();
                let (c, sn) = crate::math::direction::cos_sin_turn(u[1]);
                s.center + crate::math::direction::about(s.n, r * c, r * sn, 0.0)
            }
        }
    }
}
