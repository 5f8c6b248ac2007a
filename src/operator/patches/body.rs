//! A primitive in the form used to test whether it blocks rays: its plane and outline, or its sphere.

use crate::scene::Primitive;
use glam::DVec3;

/// Outlines are enlarged by this share of the edge length, so that neighbours leave no gap.
pub(super) const SLACK: f64 = 1e-12;

/// Outline of a flat primitive, in its own coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) enum Outline {
    Triangle,
    Parallelogram,
    Disk { radius_squared: f64 },
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Body {
    Flat { origin: DVec3, normal: DVec3, u: DVec3, v: DVec3, outline: Outline },
    Sphere { center: DVec3, radius: f64, z: [f64; 2], inward: bool },
}

pub(super) fn body(p: Primitive) -> Body {
    let flat = |origin: DVec3, u: DVec3, v: DVec3, outline| {
        let n = u.cross(v);
        let k = 1.0 / n.length_squared();
        Body::Flat { origin, normal: n.normalize(), u: v.cross(n) * k, v: n.cross(u) * k, outline }
    };
    match p {
        Primitive::Triangle([a, b, c]) => flat(a, b - a, c - a, Outline::Triangle),
        Primitive::Parallelogram { origin, edge_u, edge_v } => flat(origin, edge_u, edge_v, Outline::Parallelogram),
        Primitive::Disk { center, normal, radius } => {
            let (u, v) = normal.any_orthonormal_pair();
            Body::Flat { origin: center, normal, u, v, outline: Outline::Disk { radius_squared: radius * radius } }
        }
        Primitive::Sphere { center, radius, z, inward } => Body::Sphere { center, radius, z, inward },
    }
}

impl Body {
    /// The first crossing with 0 < t < `limit`: its t, and true if the ray comes from the front.
    #[inline]
    pub(super) fn crossing(&self, o: DVec3, d: DVec3, limit: f64) -> Option<(f64, bool)> {
        match *self {
            Self::Flat { origin, normal, u, v, outline } => {
                let (height, slope) = (normal.dot(o - origin), normal.dot(d));
                if height * slope >= 0.0 || height.abs() >= limit * slope.abs() {
                    return None;
                }
                let t = -height / slope;
                let p = o + t * d - origin;
                let (u, v) = (p.dot(u), p.dot(v));
                let inside = match outline {
                    Outline::Parallelogram => (u - 0.5).abs() <= 0.5 + SLACK && (v - 0.5).abs() <= 0.5 + SLACK,
                    Outline::Triangle => u >= -SLACK && v >= -SLACK && u + v <= 1.0 + SLACK,
                    Outline::Disk { radius_squared } => u * u + v * v <= radius_squared,
                };
                inside.then_some((t, height > 0.0))
            }
            Self::Sphere { center, radius, z, inward } => {
                let m = o - center;
                let (a, b, c) = (d.length_squared(), m.dot(d), m.length_squared() - radius * radius);
                let root = b * b - a * c;
                if root <= 0.0 {
                    return None;
                }
                let root = root.sqrt();
                // the numerically stable pair of roots, which does not subtract nearly equal numbers
                let q = if b > 0.0 { -b - root } else { -b + root };
                let (s, t) = (q / a, c / q);
                let kept = |t: f64| {
                    let height = (m.z + t * d.z) / radius;
                    t > 0.0 && t < limit && height >= z[0] - SLACK && height <= z[1] + SLACK
                };
                let (near, far) = (s.min(t), s.max(t));
                // a ray that enters the sphere hits its outside; a ray that leaves hits its inside
                if kept(near) {
                    Some((near, !inward))
                } else if kept(far) {
                    Some((far, inward))
                } else {
                    None
                }
            }
        }
    }
}
