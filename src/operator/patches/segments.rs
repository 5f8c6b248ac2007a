//! Visibility of a pair of patches: sixty-four segments are tested against one primitive at a time.
//!
//! ```text
//! h₀ = n·(x − o),  h₁ = n·(y − o)        crossed:  h₀h₁ < 0  and  x + (h₀/(h₀ − h₁))(y − x) inside the outline
//! ```
//!
//! The simple reference is [`BruteForce`](super::BruteForce), which tests one segment at a time; a test compares both. The
//! loops over lanes (one lane per segment) are ordinary Rust that the compiler vectorises. `pulp` compiles them for several
//! instruction sets and chooses one at run time.

use super::body::{Body, Outline, SLACK};
use super::patch::{Patch, SurfacePoint};
use super::polygon::{area_vector, at};
use glam::DVec3;
use pulp::{Arch, Simd};

/// Number of segments in a batch.
pub(crate) const LANES: usize = 64;
/// One number per segment.
pub(crate) type Lane = [f64; LANES];

/// A batch of point pairs, one point on each of two patches, with the weight of each pair.
#[derive(Clone, Debug)]
pub(crate) struct Segments {
    pub(crate) from: [Lane; 3],
    pub(crate) to: [Lane; 3],
    /// cos θ cos θ'/r² times the Jacobian of the points (area per unit of the random numbers); 0 for pairs that do not face
    /// each other.
    pub(crate) weight: Lane,
    /// 1 if the segment is blocked, else 0.
    pub(crate) blocked: Lane,
    /// Distance by which both ends are moved off their surfaces, metres.
    offset: f64,
}

impl Segments {
    /// Room for a batch whose ends are moved by `offset` off their surfaces.
    pub(crate) fn new(offset: f64) -> Self {
        let zero = [0.0; LANES];
        Self { from: [zero; 3], to: [zero; 3], weight: zero, blocked: zero, offset }
    }

    /// Places the end points of all segments on the parts `pa` and `pb` of two patches, at the random `numbers` in [0, 1)⁴.
    /// No segment is blocked yet. `flat_kernel` is false for pairs on one sphere, where the kernel is constant.
    pub(crate) fn place(
        &mut self,
        (a, pa): (&Patch, &[DVec3]),
        (b, pb): (&Patch, &[DVec3]),
        numbers: &[Lane; 4],
        flat_kernel: bool,
    ) {
        let mut density = [[1.0; LANES]; 2];
        let [u, v, s, t] = numbers;
        points(pa, a.normal, [u, v], &mut self.from, &mut density[0]);
        points(pb, b.normal, [s, t], &mut self.to, &mut density[1]);
        let normals = flat_kernel.then_some([a.normal, b.normal]);
        weigh(Weighing { normals, density: &density, from: &self.from, to: &self.to, weight: &mut self.weight });
        self.blocked = [0.0; LANES];
        lift(a, self.offset, &mut self.from);
        lift(b, self.offset, &mut self.to);
    }

    /// Both ends of segment `k`, moved back onto their surfaces.
    pub(crate) fn ends(&self, k: usize, a: &Patch, b: &Patch) -> [SurfacePoint; 2] {
        let back = |patch: &Patch, lanes: &[Lane; 3]| {
            let p = DVec3::new(lanes[0][k], lanes[1][k], lanes[2][k]);
            if patch.ball.is_some() { patch.lift(p) } else { patch.lift(p - self.offset * patch.normal) }
        };
        [back(a, &self.from), back(b, &self.to)]
    }
}

fn points(part: &[DVec3], normal: DVec3, [u, v]: [&Lane; 2], out: &mut [Lane; 3], density: &mut Lane) {
    match *part {
        [p, q, r, s] => bilinear(Bilinear { corners: [p, q, r, s], normal, u, v, out, density }),
        _ => {
            for k in 0..LANES {
                let (x, w) = at(part, u[k], v[k]);
                (out[0][k], out[1][k], out[2][k], density[k]) = (x.x, x.y, x.z, w);
            }
        }
    }
}

fn lift(patch: &Patch, offset: f64, p: &mut [Lane; 3]) {
    if patch.ball.is_none() {
        for (lane, shift) in p.iter_mut().zip((offset * patch.normal).to_array()) {
            lane.iter_mut().for_each(|x| *x += shift);
        }
        return;
    }
    let [x, y, z] = p;
    for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
        let on = patch.lift(DVec3::new(*x, *y, *z));
        (*x, *y, *z) = (on.position + offset * on.normal).into();
    }
}

struct Bilinear<'a> {
    corners: [DVec3; 4],
    normal: DVec3,
    u: &'a Lane,
    v: &'a Lane,
    out: &'a mut [Lane; 3],
    density: &'a mut Lane,
}

/// The bilinear map p + u e + v f + uv g. Its Jacobian n·(e + v g) × (f + u g), stored in `density`, is linear in u and v.
#[pulp::with_simd(bilinear = Arch::new())]
#[inline(always)]
fn bilinear_with_simd<'a, S: Simd>(_simd: S, job: Bilinear<'a>) {
    let Bilinear { corners: [p, q, r, s], normal, u, v, out, density } = job;
    let (e, f, g) = (q - p, s - p, p - q + r - s);
    let along = |x: DVec3, y: DVec3| normal.dot(x.cross(y));
    let (d0, du, dv) = (along(e, f), along(e, g), along(g, f));
    let [x, y, z] = out;
    for k in 0..LANES {
        let (u, v) = (u[k], v[k]);
        let w = u * v;
        x[k] = p.x + u * e.x + v * f.x + w * g.x;
        y[k] = p.y + u * e.y + v * f.y + w * g.y;
        z[k] = p.z + u * e.z + v * f.z + w * g.z;
        density[k] = d0 + u * du + v * dv;
    }
}

struct Weighing<'a> {
    normals: Option<[DVec3; 2]>,
    density: &'a [Lane; 2],
    from: &'a [Lane; 3],
    to: &'a [Lane; 3],
    weight: &'a mut Lane,
}

#[pulp::with_simd(weigh = Arch::new())]
#[inline(always)]
fn weigh_with_simd<'a, S: Simd>(_simd: S, job: Weighing<'a>) {
    let Weighing { normals, density, from, to, weight } = job;
    let Some([n, m]) = normals else {
        for k in 0..LANES {
            weight[k] = density[0][k] * density[1][k];
        }
        return;
    };
    for k in 0..LANES {
        let r = DVec3::new(to[0][k] - from[0][k], to[1][k] - from[1][k], to[2][k] - from[2][k]);
        let square = r.length_squared();
        let w = density[0][k] * density[1][k] * n.dot(r) * -m.dot(r) / (square * square);
        // rounding may place points of a clipped part below the horizon, and touching parts may share a point
        weight[k] = if (w > 0.0) & (w < f64::INFINITY) { w } else { 0.0 };
    }
}

struct Crossing<'a> {
    normal: DVec3,
    origin: DVec3,
    dual: [DVec3; 2],
    outline: Outline,
    segments: &'a mut Segments,
}

#[pulp::with_simd(cross = Arch::new())]
#[inline(always)]
fn cross_with_simd<'a, S: Simd>(_simd: S, job: Crossing<'a>) {
    let Crossing { normal, origin, dual: [du, dv], outline, segments } = job;
    match outline {
        Outline::Parallelogram => cross_lanes(normal, origin, segments, |p| {
            ((p.dot(du) - 0.5).abs() <= 0.5 + SLACK) & ((p.dot(dv) - 0.5).abs() <= 0.5 + SLACK)
        }),
        Outline::Triangle => cross_lanes(normal, origin, segments, |p| {
            let (u, v) = (p.dot(du), p.dot(dv));
            (u >= -SLACK) & (v >= -SLACK) & (u + v <= 1.0 + SLACK)
        }),
        Outline::Disk { radius_squared } => cross_lanes(normal, origin, segments, |p| {
            let (u, v) = (p.dot(du), p.dot(dv));
            u * u + v * v <= radius_squared
        }),
    }
}

#[inline(always)]
fn cross_lanes(normal: DVec3, origin: DVec3, segments: &mut Segments, inside: impl Fn(DVec3) -> bool) {
    let Segments { from: [ax, ay, az], to: [bx, by, bz], blocked, .. } = segments;
    for k in 0..LANES {
        let x = DVec3::new(ax[k] - origin.x, ay[k] - origin.y, az[k] - origin.z);
        let y = DVec3::new(bx[k] - origin.x, by[k] - origin.y, bz[k] - origin.z);
        let (h, g) = (normal.dot(x), normal.dot(y));
        let p = x + (y - x) * (h / (h - g));
        let crossed = (h * g < 0.0) & inside(p);
        blocked[k] = if crossed { 1.0 } else { blocked[k] };
    }
}

/// Marks the segments that cross the body between their ends.
pub(super) fn block(body: &Body, segments: &mut Segments) {
    match *body {
        Body::Flat { origin, normal, u, v, outline } => {
            cross(Crossing { normal, origin, dual: [u, v], outline, segments });
        }
        Body::Sphere { .. } => {
            for k in 0..LANES {
                let end = |lanes: &[Lane; 3]| DVec3::new(lanes[0][k], lanes[1][k], lanes[2][k]);
                let (x, y) = (end(&segments.from), end(&segments.to));
                if body.crossing(x, y - x, 1.0).is_some() {
                    segments.blocked[k] = 1.0;
                }
            }
        }
    }
}

/// Returns true if the flat body cuts every segment between a corner of `a` and a corner of `b`. Because the body and both
/// polygons are convex, it then hides them from each other completely: its plane cuts the convex hull of `a` and `b` in the
/// convex hull of these crossing points.
pub(super) fn hides(body: &Body, a: &[DVec3], b: &[DVec3]) -> bool {
    let Body::Flat { .. } = body else { return false };
    debug_assert!(area_vector(a) != DVec3::ZERO && area_vector(b) != DVec3::ZERO);
    a.iter().all(|x| b.iter().all(|y| body.crossing(*x, *y - *x, 1.0).is_some()))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::operator::patches::{BruteForce, Patches};
    use crate::scene::Primitive;
    use crate::scene::description::{CameraDescription, Description, Geometry, Material, Shape, Sides};

    fn scene() -> Description {
        let v = DVec3::new;
        let geometries = [
            Geometry::Box { min: DVec3::NEG_ONE, max: DVec3::ONE, rotate_y: 0.0, inward: true },
            Geometry::Box { min: v(-0.5, -1.0, -0.4), max: v(0.1, 0.2, 0.3), rotate_y: 25.0, inward: false },
            Geometry::Sphere { center: v(0.5, -0.2, 0.3), radius: 0.3, z: [-0.6, 0.7], inward: false },
            Geometry::Disk { center: v(0.3, 0.4, -0.2), normal: v(0.2, -1.0, 0.1).normalize(), radius: 0.3 },
            Geometry::Mesh {
                vertices: vec![v(-0.8, 0.3, -0.2), v(-0.2, 0.5, 0.6), v(-0.6, 0.6, 0.1)],
                faces: vec![[0, 1, 2]],
                uvs: vec![],
            },
        ];
        let shape = |geometry| Shape { name: "s".into(), geometry, material: 0, emission: DVec3::ZERO };
        Description {
            name: "lanes".into(),
            camera: CameraDescription { origin: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, fov: 40.0, size: [8, 8] },
            materials: vec![Material::diffuse("m", DVec3::splat(0.5), Sides::Both)],
            shapes: geometries.map(shape).to_vec(),
            lights: vec![],
            expect: None,
        }
    }

    #[test]
    fn lanes_and_single_segments_meet_the_same() {
        let scene = scene();
        let (patches, caster) = (Patches::new(&scene, 60).unwrap(), BruteForce::new(&scene));
        let mut segments = caster.segments();
        let numbers =
            [0.311, 0.577, 0.731, 0.919].map(|step: f64| std::array::from_fn(|k| (0.5 + step * k as f64).fract()));
        let mut met = vec![[0u32; 2]; caster.len()];
        for (i, a) in patches.iter().enumerate() {
            let b = &patches[(i * 37 + 11) % patches.len()];
            segments.place((a, &a.polygon), (b, &b.polygon), &numbers, true);
            for (number, met) in met.iter_mut().enumerate() {
                segments.blocked = [0.0; LANES];
                caster.block(number, &mut segments);
                for k in 0..LANES {
                    let [x, y] = segments.ends(k, a, b);
                    let free = caster.free(x, y, std::iter::once(number));
                    // the ends are only just off their own flat surface, so rounding decides there
                    let own = a.primitive == number || b.primitive == number;
                    assert!(own || free == (segments.blocked[k] == 0.0), "{number} {k} {x:?} {y:?}");
                    met[usize::from(free)] += 1;
                }
            }
        }
        assert!(met.iter().all(|[blocked, free]| *blocked > 20 && *free > 20), "{met:?}");
    }

    #[test]
    fn weights_are_densities_times_the_kernel() {
        let scene = scene();
        let patches = Patches::new(&scene, 60).unwrap();
        let caster = BruteForce::new(&scene);
        let mut segments = caster.segments();
        let numbers =
            [0.311, 0.577, 0.731, 0.919].map(|step: f64| std::array::from_fn(|k| (0.5 + step * k as f64).fract()));
        let (mut corners, mut facing) = ([0; 6], 0);
        for (i, a) in patches.iter().enumerate().filter(|(_, p)| p.ball.is_none()) {
            let b = &patches[(i * 37 + 11) % patches.len()];
            corners[a.polygon.len()] += 1;
            segments.place((a, &a.polygon), (b, &b.polygon), &numbers, true);
            for (k, found) in segments.weight.iter().enumerate() {
                let (x, v) = at(&a.polygon, numbers[0][k], numbers[1][k]);
                let (y, w) = at(&b.polygon, numbers[2][k], numbers[3][k]);
                let r = y - x;
                let weight = v * w * a.normal.dot(r) * -b.normal.dot(r) / r.length_squared().powi(2);
                facing += u32::from(weight > 0.0);
                assert!((found - weight.max(0.0)).abs() <= 1e-12 * weight.abs().max(v * w), "{i} {k}");
            }
        }
        assert!(
            facing > 500
                && corners[3] > 0
                && corners[4] > 0
                && matches!(scene.primitives()[0].1, Primitive::Parallelogram { .. })
        );
    }
}
