//! The form factors of a mesh of patches: the geometry of the discrete operator.
//!
//! ```text
//! Aᵢ Fᵢⱼ = sᵢ sⱼ Vᵢⱼ ∫∫ cos θ cos θ' / πr² dA dA'        Σⱼ Fᵢⱼ ≤ 1,   Aᵢ Fᵢⱼ = Aⱼ Fⱼᵢ
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | Fᵢⱼ | share of the diffuse power leaving patch i that arrives at patch j | [`FormFactors::f`] |
//! | Aᵢ | area of the true surface of patch i that no other surface covers, m² | [`FormFactors::area`] |
//! | sᵢ | area of the true surface over area of its flat polygon | [`Patch::stretch`] |
//! | Vᵢⱼ | visible share of the pair, in [0, 1] | [`VisibilitySampling`] |
//!
//! Two patches on the inside of one sphere of radius R need no flat facets. There the kernel is the constant 1/4πR², so that
//! AᵢFᵢⱼ = Vᵢⱼ AᵢAⱼ/4πR²; this includes i = j.

mod closure;
mod geometry;
mod invariants;
mod shaft;
mod visibility;

use crate::operator::patches::{BruteForce, LANES, Patch, Patches, Segments, polygon::radius_about};
use crate::progress::Progress;
use crate::scene::description::Sides;
use geometry::{Side, exchange, facing};
pub use geometry::{point_to_polygon, polygon_to_polygon};
pub use invariants::Invariants;
use rayon::prelude::*;
use shaft::{Blocker, End, Shaft};
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use visibility::visible_share;
pub use visibility::{Visibility, VisibilitySampling};

/// The matrix F of form factors, with the areas for which AᵢFᵢⱼ is symmetric.
#[derive(Clone, Debug, PartialEq)]
pub struct FormFactors {
    /// Number of patches.
    pub n: usize,
    /// The form factors: Fᵢⱼ at `i·n + j`.
    pub f: Vec<f32>,
    /// The areas Aᵢ of the patches, m².
    pub area: Vec<f64>,
    /// Number of visibility rays traced.
    pub rays: u64,
}

/// The computation was stopped before it finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the computation of the form factors was stopped before it finished")]
pub struct Stopped;

/// Largest number of possible blockers listed per pair. With more, the visibility test searches the whole scene.
const MAX_LISTED: usize = 32;

impl FormFactors {
    /// Computes all form factors: the upper triangle by integration, the lower triangle by reciprocity. The result does not
    /// depend on the number of threads.
    ///
    /// # Errors
    /// [`Stopped`] if `progress` asks to stop.
    pub fn new(
        patches: &Patches,
        visibility: &dyn Visibility,
        sampling: VisibilitySampling,
        progress: Progress<'_>,
    ) -> Result<Self, Stopped> {
        let n = patches.len();
        let area = patches.areas();
        let blockers: Vec<Blocker> = patches.primitives().iter().map(Blocker::new).collect();
        let sides: Vec<Side> = patches.iter().map(side).collect();
        let bodies = BruteForce::of(patches.primitives().iter().map(|p| (*p, Sides::Both)));
        let pairs = Pairs { patches, sides, blockers, bodies, visibility, sampling };
        let rays = AtomicU64::new(0);

        let mut f = vec![0.0f32; n * n];
        f.par_chunks_mut(n).with_max_len(1).enumerate().for_each(|(i, row)| {
            if progress.stopped() {
                return;
            }
            let mut work = Scratch::new(&pairs.bodies);
            for (j, entry) in row.iter_mut().enumerate().skip(i) {
                *entry = (pairs.exchange(i, j, &mut work) / area[i]) as f32;
            }
            rays.fetch_add(work.sight.rays, Relaxed);
            progress.advance(1);
        });
        if progress.stopped() {
            return Err(Stopped);
        }
        mirror(&mut f, &area);
        Ok(Self { n, f, area, rays: rays.into_inner() })
    }

    /// Row i of F.
    pub fn row(&self, i: usize) -> &[f32] {
        &self.f[i * self.n..(i + 1) * self.n]
    }

    /// Measures closure (row sums), reciprocity and bounds of the entries.
    pub fn invariants(&self) -> Invariants {
        Invariants::of(self)
    }
}

/// Sets Fⱼᵢ = Fᵢⱼ Aᵢ/Aⱼ for i < j, tile by tile so that the data stay in the cache.
fn mirror(f: &mut [f32], area: &[f64]) {
    const TILE: usize = 64;
    let n = area.len();
    for i0 in (0..n).step_by(TILE) {
        for j0 in (i0..n).step_by(TILE) {
            for i in i0..(i0 + TILE).min(n) {
                for j in j0.max(i + 1)..(j0 + TILE).min(n) {
                    f[j * n + i] = (f64::from(f[i * n + j]) * (area[i] / area[j])) as f32;
                }
            }
        }
    }
}

fn side(p: &Patch) -> Side {
    Side { normal: p.normal, centre: p.centre, radius: radius_about(&p.polygon, p.centre), area: p.flat_area }
}

struct Pairs<'a> {
    patches: &'a Patches,
    sides: Vec<Side>,
    blockers: Vec<Blocker>,
    bodies: BruteForce,
    visibility: &'a dyn Visibility,
    sampling: VisibilitySampling,
}

struct Scratch {
    a: Vec<glam::DVec3>,
    b: Vec<glam::DVec3>,
    sight: Sight,
}

/// Working memory for the visibility test of one pair.
struct Sight {
    among: Vec<u32>,
    segments: Segments,
    rays: u64,
}

impl Scratch {
    fn new(bodies: &BruteForce) -> Self {
        let sight = Sight { among: Vec::new(), segments: bodies.segments(), rays: 0 };
        Self { a: Vec::new(), b: Vec::new(), sight }
    }
}

impl Pairs<'_> {
    /// The product Aᵢ Fᵢⱼ, m².
    fn exchange(&self, i: usize, j: usize, work: &mut Scratch) -> f64 {
        let (a, b) = (&self.patches[i], &self.patches[j]);
        if let (Some((_, radius)), true) = (a.ball, a.ball == b.ball) {
            // a sphere seen from outside is convex: no point of it sees another
            if !(a.is_concave() && b.is_concave()) {
                return 0.0;
            }
            let clear = a.stretch * a.flat_area * b.stretch * b.flat_area / (2.0 * TAU * radius * radius);
            return clear * self.visible(i, j, [&a.polygon, &b.polygon], false, &mut work.sight);
        }
        if a.primitive == b.primitive {
            return 0.0;
        }
        let (sa, sb) = (&self.sides[i], &self.sides[j]);
        let Some((pa, pb)) = facing(&a.polygon, sa, &b.polygon, sb, &mut work.a, &mut work.b) else { return 0.0 };
        let share = self.visible(i, j, [pa, pb], true, &mut work.sight);
        if share == 0.0 { 0.0 } else { share * a.stretch * b.stretch * exchange(pa, sa, pb, sb) }
    }

    /// The visible share Vᵢⱼ of the two polygons `pa` and `pb`.
    fn visible(
        &self,
        i: usize,
        j: usize,
        [pa, pb]: [&[glam::DVec3]; 2],
        flat_kernel: bool,
        Sight { among, segments, rays }: &mut Sight,
    ) -> f64 {
        let (a, b) = (&self.patches[i], &self.patches[j]);
        let (ea, eb) = (End::new(a, pa), End::new(b, pb));
        let shaft = Shaft::new(&ea, &eb);
        let flat = a.ball.is_none() && b.ball.is_none();
        among.clear();
        for (k, blocker) in self.blockers.iter().enumerate() {
            let own = (k == a.primitive && a.ball.is_none()) || (k == b.primitive && b.ball.is_none());
            if !own && blocker.may_block(&shaft) {
                if flat && self.bodies.hides(k, pa, pb) {
                    return 0.0;
                }
                among.push(k as u32);
                if among.len() > MAX_LISTED {
                    break;
                }
            }
        }
        if among.is_empty() {
            return 1.0;
        }
        let pair = (i as u64) << 32 | j as u64;
        let (share, traced) = visible_share(self.sampling, (a, pa), (b, pb), flat_kernel, pair, segments, |segments| {
            if among.len() <= MAX_LISTED {
                among.iter().for_each(|k| self.bodies.block(*k as usize, segments));
                return;
            }
            for k in 0..LANES {
                let [x, y] = segments.ends(k, a, b);
                segments.blocked[k] = f64::from(u8::from(!self.visibility.visible(x, y)));
            }
        });
        *rays += u64::from(traced);
        share
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::operator::patches::BruteForce;
    use crate::progress::Listener;
    use crate::scene::description::*;
    use glam::DVec3;
    use std::sync::atomic::AtomicBool;

    /// A room that contains a rotated block, a sphere and a disk.
    fn clutter() -> Description {
        let geometries = [
            Geometry::Box { min: DVec3::NEG_ONE, max: DVec3::ONE, rotate_y: 0.0, inward: true },
            Geometry::Box {
                min: DVec3::new(-0.6, -1.0, -0.6),
                max: DVec3::new(0.0, 0.1, 0.0),
                rotate_y: 20.0,
                inward: false,
            },
            Geometry::Sphere { center: DVec3::new(0.4, -0.3, 0.3), radius: 0.3, z: [-1.0, 1.0], inward: false },
            Geometry::Disk { center: DVec3::new(0.1, 0.7, 0.0), normal: DVec3::new(0.2, -1.0, 0.1), radius: 0.3 },
        ];
        let shape = |geometry| Shape { name: "s".into(), geometry, material: 0, emission: DVec3::ZERO };
        Description {
            name: "clutter".into(),
            camera: CameraDescription { origin: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, fov: 40.0, size: [8, 8] },
            materials: vec![Material::diffuse("m", DVec3::splat(0.5), Sides::Front)],
            shapes: geometries.map(shape).to_vec(),
            lights: vec![],
            expect: None,
        }
    }

    #[test]
    fn what_the_shaft_test_leaves_out_never_blocks() {
        let scene = clutter();
        let patches = Patches::new(&scene, 150).unwrap();
        let caster = BruteForce::new(&scene);
        let blockers: Vec<Blocker> = patches.primitives().iter().map(Blocker::new).collect();
        let mut segments = caster.segments();
        let (mut ruled_out, mut tried) = (0, 0);
        for (i, a) in patches.iter().enumerate() {
            for (j, b) in patches.iter().enumerate().skip(i + 1) {
                if a.primitive == b.primitive {
                    continue;
                }
                let (mut ca, mut cb) = (Vec::new(), Vec::new());
                let Some((pa, pb)) = facing(&a.polygon, &side(a), &b.polygon, &side(b), &mut ca, &mut cb) else {
                    continue;
                };
                let (ea, eb) = (End::new(a, pa), End::new(b, pb));
                let shaft = Shaft::new(&ea, &eb);
                let own = |k: usize| (k == a.primitive && a.ball.is_none()) || (k == b.primitive && b.ball.is_none());
                let out: Vec<u32> = (0..blockers.len())
                    .filter(|k| own(*k) || !blockers[*k].may_block(&shaft))
                    .map(|k| k as u32)
                    .collect();
                tried += blockers.len();
                ruled_out += out.len();
                let fine = VisibilitySampling { rays: 40, refined: 40 };
                let pair = (i * patches.len() + j) as u64;
                let (share, _) = visible_share(fine, (a, pa), (b, pb), true, pair, &mut segments, |segments| {
                    for k in 0..LANES {
                        // if one point is below the true horizon of the other, the operator does not use the pair
                        let [x, y] = segments.ends(k, a, b);
                        let r = y.position - x.position;
                        let apart = x.normal.dot(r) <= 0.0 || y.normal.dot(r) >= 0.0;
                        let free = apart || caster.free(x, y, out.iter().map(|i| *i as usize));
                        segments.blocked[k] = f64::from(u8::from(!free));
                    }
                });
                assert_eq!(share, 1.0, "{i} {j}");
            }
        }
        assert!(ruled_out * 8 > tried * 7, "{ruled_out} of {tried}: the test is not sharp");
    }

    #[test]
    fn what_is_called_hidden_is_never_seen() {
        let scene = clutter();
        let patches = Patches::new(&scene, 400).unwrap();
        let caster = BruteForce::new(&scene);
        let mut segments = caster.segments();
        let (mut hidden, fine) = (0, VisibilitySampling { rays: 64, refined: 64 });
        for (i, a) in patches.iter().enumerate().filter(|(_, p)| p.ball.is_none()) {
            for (j, b) in patches.iter().enumerate().skip(i + 1).filter(|(_, p)| p.ball.is_none()) {
                let (mut ca, mut cb) = (Vec::new(), Vec::new());
                let Some((pa, pb)) = facing(&a.polygon, &side(a), &b.polygon, &side(b), &mut ca, &mut cb) else {
                    continue;
                };
                for k in (0..caster.len()).filter(|k| *k != a.primitive && *k != b.primitive) {
                    if caster.hides(k, pa, pb) {
                        hidden += 1;
                        let block = |segments: &mut Segments| caster.block(k, segments);
                        let pair = (i * patches.len() + j) as u64;
                        assert_eq!(visible_share(fine, (a, pa), (b, pb), true, pair, &mut segments, block).0, 0.0);
                    }
                }
            }
        }
        assert!(hidden > 1000, "{hidden}");
    }

    #[test]
    fn the_result_does_not_depend_on_threads_and_can_be_stopped() {
        let scene = clutter();
        let patches = Patches::new(&scene, 100).unwrap();
        let caster = BruteForce::new(&scene);
        let make =
            |progress: Progress<'_>| FormFactors::new(&patches, &caster, VisibilitySampling::default(), progress);
        let in_pool = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| make(Progress::NONE).unwrap())
        };
        assert_eq!(in_pool(1), in_pool(3));

        /// Stops after ten rows.
        #[derive(Default)]
        struct Ten(AtomicU64, AtomicBool);
        impl Listener for Ten {
            fn advance(&self, rows: u64) {
                self.1.store(self.0.fetch_add(rows, Relaxed) + rows >= 10, Relaxed);
            }
        }
        let ten = Ten::default();
        assert_eq!(make(Progress::to(&ten).stopped_by(&ten.1)), Err(Stopped));
        assert!(ten.0.into_inner() < patches.len() as u64);
    }
}
