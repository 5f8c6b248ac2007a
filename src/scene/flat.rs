//! The parallelogram, ready for rays: its plane, the coordinates across it, and the test of its edges.
//!
//! ```text
//! t = (h − n·o)/(n·d)        |u|, |v| ≤ 1 with u = a·p + a0, v = b·p + b0        p = o + t d
//! ```
//!
//! Close to an edge, where rounding decides, the test of a triangle's edges is used; see [`shape`](super::shape).

use super::plucker;
use super::rounding::{KEEP, MOST_KEEP, UNSURE, across, dot, onto};
use glam::{DVec3, Vec3};

/// Volume between a ray and an edge, whose ends are given relative to the start of the ray. The sign is exactly opposite if
/// the ends are exchanged.
#[inline(always)]
fn edge(a: Vec3, b: Vec3, d: Vec3) -> f32 {
    plucker::edge(a.to_array(), b.to_array(), d.to_array())
}

/// How a parallelogram lies. Products with zero are left out.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    /// Its normal is along this axis, its edges along the other two.
    Aligned(usize),
    /// One edge is along this axis, normal and other edge across it: the side of a box that stands.
    Upright(usize),
    General,
}

/// A parallelogram, ready for rays, in the plane `n·p = h`. The coordinates `a·p + a0` and `b·p + b0` run from −1/s to 1/s
/// across it, with s = 1 − R and R in units of half the width. If both are in [−1, 1], a hit is certain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flat {
    pub(super) n: Vec3,
    pub(super) h: f32,
    pub(super) a: Vec3,
    pub(super) a0: f32,
    pub(super) b: Vec3,
    pub(super) b0: f32,
    /// Largest coordinate at which rounding may decide the result; from 1 up to here the edge test is used.
    pub(super) band: f32,
    /// s for both coordinates.
    pub(super) sure: [f32; 2],
    pub(super) corners: [Vec3; 4],
    pub(super) center: Vec3,
    pub(super) half_u: Vec3,
    pub(super) half_v: Vec3,
    /// (1 − M)/s for both coordinates: hits are kept inside this range.
    pub(super) keep: [f32; 2],
    /// Below both of `keep` by more than the rounding of a coordinate.
    deep: f32,
    pub(super) form: Form,
    /// Of an aligned or upright parallelogram: the coordinates that [`Self::look_aligned`] or [`Self::look_upright`] uses.
    along: [f32; 5],
}

impl Flat {
    /// `touch` is the largest difference of two corners that are meant to be the same, m.
    pub(super) fn new(origin: DVec3, u: DVec3, v: DVec3, touch: f64) -> Self {
        let g = u.cross(v);
        let (gg, n) = (g.length_squared(), g.normalize());
        let (a, b) = (2.0 * v.cross(g) / gg, 2.0 * g.cross(u) / gg);
        // 1/|a| is half the width between the edges along v
        let corners = [origin, origin + u, origin + v, origin + u + v];
        let round = [a, b].map(|a| across(a, &corners));
        let touch = [a, b].map(|a| touch * a.length());
        let part = |k: f64, most: f64| [0, 1].map(|i| (k * round[i] + touch[i]).min(most));
        let sure = part(UNSURE, 0.25).map(|r| 1.0 - r);
        let [wide, long] = [0, 1].map(|i| (1.0 + part(KEEP, 0.5)[i]) / sure[i]);
        // coordinates before and after the projection differ by rounding only: R is twice the error of one
        let deep = [0, 1].map(|i| (1.0 - part(KEEP, MOST_KEEP)[i] - 2.0 * UNSURE * round[i]) / sure[i]);
        let f = |v: DVec3| v.as_vec3();
        let flat = Self {
            form: Form::General,
            along: [0.0; 5],
            n: f(n),
            h: n.dot(origin) as f32,
            a: f(a / sure[0]),
            a0: ((-1.0 - a.dot(origin)) / sure[0]) as f32,
            b: f(b / sure[1]),
            b0: ((-1.0 - b.dot(origin)) / sure[1]) as f32,
            band: wide.max(long) as f32,
            sure: sure.map(|s| s as f32),
            corners: [0, 1, 3, 2].map(|i| f(corners[i])),
            center: f(origin + 0.5 * (u + v)),
            half_u: f(0.5 * u),
            half_v: f(0.5 * v),
            keep: [0, 1].map(|i| ((1.0 - part(KEEP, MOST_KEEP)[i]) / sure[i]) as f32),
            deep: deep[0].min(deep[1]) as f32,
        };
        flat.with_form()
    }

    /// Sets [`Self::form`] and [`Self::along`].
    fn with_form(self) -> Self {
        let only = |v: Vec3, axis: usize| (0..3).all(|i| i == axis || v[i] == 0.0);
        let pairs = [[(self.a, self.a0), (self.b, self.b0)], [(self.b, self.b0), (self.a, self.a0)]];
        for axis in 0..3 {
            let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
            for [(a, a0), (b, b0)] in pairs {
                if only(self.n, axis) && only(a, one) && only(b, other) {
                    return Self { form: Form::Aligned(axis), along: [a[one], a0, b[other], b0, 0.0], ..self };
                }
            }
        }
        for axis in 0..3 {
            let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
            for [(a, a0), (b, b0)] in pairs {
                if self.n[axis] == 0.0 && only(a, axis) && b[axis] == 0.0 {
                    return Self { form: Form::Upright(axis), along: [a[axis], a0, b[one], b[other], b0], ..self };
                }
            }
        }
        self
    }

    /// How many numbers [`Self::look`] and [`Self::near`] use.
    pub(crate) const NUMBERS: usize = 13;

    /// These numbers.
    pub(crate) fn numbers(&self) -> [f32; Self::NUMBERS] {
        let Self { n, h, a, a0, b, b0, band, .. } = *self;
        [n.x, n.y, n.z, h, a.x, a.y, a.z, a0, b.x, b.y, b.z, b0, band]
    }

    /// A parallelogram with these numbers. It has no corners.
    #[inline(always)]
    pub(crate) fn with_numbers(x: [f32; Self::NUMBERS]) -> Self {
        let v = |i: usize| Vec3::new(x[i], x[i + 1], x[i + 2]);
        Self {
            n: v(0),
            h: x[3],
            a: v(4),
            a0: x[7],
            b: v(8),
            b0: x[11],
            band: x[12],
            ..Self::spanned([0.0; Self::SPAN])
        }
    }

    /// The plane: its normal and its distance from the origin.
    pub(crate) fn plane(&self) -> (Vec3, f32) {
        (self.n, self.h)
    }

    /// If the coordinate of [`Self::look`] is at most this, the hit is inside the edges and [`Self::settle`] only projects it.
    pub(crate) fn deep(&self) -> f32 {
        self.deep
    }

    /// The numbers that [`Self::point`] uses: centre, halves of the edges, plane.
    pub(crate) fn span(&self) -> [f32; Self::SPAN] {
        let ([a, b, c], n) = ([self.center, self.half_u, self.half_v], self.n);
        [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, n.x, n.y, n.z, self.h]
    }

    /// How many numbers span a parallelogram or a triangle.
    pub(crate) const SPAN: usize = 13;

    /// A parallelogram with these numbers. It has no corners, so no ray can meet it.
    #[inline(always)]
    pub(crate) fn spanned(x: [f32; Self::SPAN]) -> Self {
        let v = |i: usize| Vec3::new(x[i], x[i + 1], x[i + 2]);
        Self {
            center: v(0),
            half_u: v(3),
            half_v: v(6),
            n: v(9),
            h: x[12],
            a: Vec3::ZERO,
            a0: 0.0,
            b: Vec3::ZERO,
            b0: 0.0,
            keep: [0.0; 2],
            deep: 0.0,
            sure: [0.0; 2],
            band: 0.0,
            form: Form::General,
            along: [0.0; 5],
            corners: [Vec3::ZERO; 4],
        }
    }

    /// The unit normal of the front.
    #[inline(always)]
    pub(crate) fn normal(&self) -> Vec3 {
        self.n
    }

    /// A uniformly distributed point, chosen by `u`.
    #[inline(always)]
    pub(crate) fn point(&self, u: [f32; 2]) -> Vec3 {
        onto(self.center + self.half_u * (2.0 * u[0] - 1.0) + self.half_v * (2.0 * u[1] - 1.0), self.n, self.h)
    }

    /// Returns the distance t, and the larger coordinate across the parallelogram in absolute value. Packets use this function
    /// lane by lane.
    #[inline(always)]
    pub(crate) fn look(&self, o: Vec3, d: Vec3) -> (f32, f32) {
        let t = (self.h - dot(self.n, o)) / dot(self.n, d);
        let p = Vec3::new(d.x * t + o.x, d.y * t + o.y, d.z * t + o.z);
        let (u, v) = ((dot(self.a, p) + self.a0).abs(), (dot(self.b, p) + self.b0).abs());
        (t, if u > v { u } else { v })
    }

    /// [`Self::look`] for [`Form::Aligned`], with half the operations: the products with zero are left out. The
    /// bits are the same; only t = ±∞, which is no hit, gives other numbers.
    #[inline(always)]
    pub(crate) fn look_aligned<const AXIS: usize>(&self, o: Vec3, d: Vec3) -> (f32, f32) {
        let (one, other, [a, a0, b, b0, _]) = ((AXIS + 1) % 3, (AXIS + 2) % 3, self.along);
        let (n, o, d) = (self.n.to_array()[AXIS], o.to_array(), d.to_array());
        let t = (self.h - n * o[AXIS]) / (n * d[AXIS]);
        let (u, v) = ((a * (d[one] * t + o[one]) + a0).abs(), (b * (d[other] * t + o[other]) + b0).abs());
        (t, if u > v { u } else { v })
    }

    /// The same for [`Form::Upright`], with two thirds of the operations.
    #[inline(always)]
    pub(crate) fn look_upright<const AXIS: usize>(&self, o: Vec3, d: Vec3) -> (f32, f32) {
        let (one, other, [a, a0, b, c, b0]) = ((AXIS + 1) % 3, (AXIS + 2) % 3, self.along);
        let (n, o, d) = (self.n.to_array(), o.to_array(), d.to_array());
        let t = (self.h - (n[one] * o[one] + n[other] * o[other])) / (n[one] * d[one] + n[other] * d[other]);
        let (up, x, y) = (d[AXIS] * t + o[AXIS], d[one] * t + o[one], d[other] * t + o[other]);
        let (u, v) = ((a * up + a0).abs(), (b * x + c * y + b0).abs());
        (t, if u > v { u } else { v })
    }

    /// Returns true if a ray meets the parallelogram at t, or passes close to its edges. It meets it if the coordinate `most` of
    /// [`Self::look`] is at most 1; if it is larger, [`Self::edges`] decides.
    #[inline(always)]
    pub(crate) fn near(&self, t: f32, most: f32) -> bool {
        (most <= self.band) & (t > 0.0)
    }

    /// Returns true if the line of the ray passes between the edges. An edge that a neighbouring primitive shares has the
    /// same sign there.
    #[inline(always)]
    pub(crate) fn edges(&self, o: Vec3, d: Vec3) -> bool {
        self.between(o.x, o.y, o.z, d.x, d.y, d.z)
    }

    /// The same with plain numbers as arguments, which are passed in registers. With a ray in memory, the loops around this
    /// rare call were half as fast.
    #[cold]
    #[inline(never)]
    fn between(&self, ox: f32, oy: f32, oz: f32, dx: f32, dy: f32, dz: f32) -> bool {
        let (o, d) = (Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz));
        let v = self.corners.map(|p| p - o);
        let w = [0, 1, 2, 3].map(|i| edge(v[(i + 1) % 4], v[i], d));
        (w.iter().all(|w| *w >= 0.0) || w.iter().all(|w| *w <= 0.0)) && w.iter().any(|w| *w != 0.0)
    }

    #[inline(always)]
    pub(super) fn meet(&self, o: Vec3, d: Vec3) -> (f32, bool) {
        let (t, most) = self.look(o, d);
        (t, self.near(t, most) && (most <= 1.0 || self.edges(o, d)))
    }

    /// The point of the plane nearest to `p`, kept inside the edges.
    #[inline(always)]
    pub(crate) fn settle(&self, p: Vec3) -> Vec3 {
        let p = onto(p, self.n, self.h);
        let (u, v, [ku, kv]) = (dot(self.a, p) + self.a0, dot(self.b, p) + self.b0, self.keep);
        if (u.abs() <= ku) & (v.abs() <= kv) {
            return p;
        }
        let back = |x: f32, k: f32| if x.abs() <= k { 0.0 } else { k.copysign(x) - x };
        p + self.half_u * (self.sure[0] * back(u, ku)) + self.half_v * (self.sure[1] * back(v, kv))
    }
}
