//! Light points for a wave of receivers, in SIMD lanes: the same formulas as [`Scene::sample_light`], sixteen at once.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | place | position of a path in the sorted order of [`groups`](super::groups) | `Rays::order` lists the paths by place |
//! | kind | what a light is; each kind has one formula | [`kind`] |
//!
//! A scene with one lamp of one primitive needs no choice. Otherwise every lane chooses a light. Each kind that some lane has
//! chosen is computed for all sixteen, and the lanes that have chosen it keep the result: there are few kinds, and sorting by
//! kind would cost more than the formulas. An image of the sky, and surfaces of other forms, follow lane by lane.

use super::emitter::{cone, environment, kind};
use super::groups::{Vertices, gather, gather3, paths};
use super::shape::{Ball, Flat, Shape, Triangle};
use super::sixteen::{LANES, Lane, Lane3, ZERO, ZERO3, get, put, put_if, store, store3};
use super::{Rays, Scene, Vertex, connection, solid_angle};
use crate::math::Columns;
use glam::Vec3;
use pulp::{Arch, Simd};

impl Scene {
    /// [`Self::sample_light`] for the first `m` places of a sorted wave, from the random numbers `rays.u` of their paths. Writes
    /// by place: direction, density, position, normal and radiance to `rays.to`, `rays.t`, `rays.q`, `rays.m` and
    /// `rays.radiance`, and to `rays.prim` whether a ray can hit the light. The density is 0 where there is no light point.
    pub(crate) fn light_wave(&self, at: Vertices, rays: &mut Rays, m: usize) {
        let Some(prim) = self.lights.only() else { return chosen_points(self, at, rays, m) };
        let density = self.lights.density[prim as usize];
        lamp_points(&self.accel.shapes[prim as usize], density, at.p, rays, m);
        rays.radiance.fill(m, self.emission(2 * prim));
        rays.prim[..m].fill(1);
    }
}

/// Sixteen receivers, with the random numbers and the lights that they have chosen.
struct Receivers {
    x: Lane3,
    side: [u32; LANES],
    u: [Lane; 4],
    light: [u32; LANES],
    kind: [u32; LANES],
    probability: Lane,
    /// Density of a constant sky.
    sky: Lane,
}

impl Receivers {
    #[inline(always)]
    fn u(&self, i: usize) -> [f32; 2] {
        [self.u[2][i], self.u[3][i]]
    }
}

/// Sixteen light points in the making.
struct Found {
    to: Lane3,
    pdf: Lane,
    q: Lane3,
    m: Lane3,
    radiance: Lane3,
}

impl Found {
    /// Replaces light point `i` if `is`.
    #[inline(always)]
    fn put(&mut self, i: usize, is: bool, to: Vec3, pdf: f32, [q, m]: [Vec3; 2]) {
        put_if(&mut self.to, i, is, to);
        put_if(&mut self.q, i, is, q);
        put_if(&mut self.m, i, is, m);
        self.pdf[i] = if is { pdf } else { self.pdf[i] };
    }
}

#[pulp::with_simd(chosen_points = Arch::new())]
#[inline(always)]
fn chosen_points_with_simd<'a, S: Simd>(_simd: S, scene: &'a Scene, at: Vertices<'a>, rays: &'a mut Rays, m: usize) {
    for place in (0..m).step_by(LANES) {
        let list = paths(&rays.order, place, m);
        let mut r = Receivers {
            x: gather3(at.p, &list),
            side: gather(at.side, &list),
            u: [
                gather(&rays.u[0], &list),
                gather(&rays.u[1], &list),
                gather(&rays.u[2], &list),
                gather(&rays.u[3], &list),
            ],
            light: [0; LANES],
            kind: [0; LANES],
            probability: ZERO,
            sky: ZERO,
        };
        let mut found = Found { to: ZERO3, pdf: ZERO, q: ZERO3, m: ZERO3, radiance: ZERO3 };
        let kinds = choose(scene, &mut r, &mut found);
        points_without_area(scene, kinds, &r, &mut found);
        if kinds & kind::BALL != 0 {
            points_of_balls(scene, &r, &mut found);
        }
        if kinds & kind::SURFACE != 0 {
            points_of_surfaces(scene, &r, &mut found);
        }
        if kinds & kind::IMAGE != 0 {
            points_of_sky(scene, &r, &mut found);
        }
        store3(&mut rays.to, place, &found.to);
        store(&mut rays.t, place, &found.pdf);
        store3(&mut rays.q, place, &found.q);
        store3(&mut rays.m, place, &found.m);
        store3(&mut rays.radiance, place, &found.radiance);
        for i in 0..LANES {
            rays.prim[place + i] = r.kind[i] & kind::HITTABLE;
        }
    }
}

/// Chooses a light in every lane: its kind, its probability, its radiance; its place or direction goes to `found.q`. Returns
/// the kinds that occur.
#[inline(always)]
fn choose(scene: &Scene, r: &mut Receivers, found: &mut Found) -> u32 {
    let mut kinds = 0;
    for i in 0..LANES {
        r.light[i] = scene.lights.choose(r.u[0][i]);
    }
    for i in 0..LANES {
        let row = scene.lights.row(r.light[i]);
        (r.kind[i], r.probability[i], r.sky[i]) = (row.kind, row.probability, row.density);
        put(&mut found.q, i, row.at);
        put(&mut found.radiance, i, row.radiance);
        kinds |= row.kind;
    }
    kinds
}

/// Point lights, parallel light, and a sky that is the same everywhere.
#[inline(always)]
fn points_without_area(scene: &Scene, kinds: u32, r: &Receivers, found: &mut Found) {
    if kinds & kind::POINT != 0 {
        for i in 0..LANES {
            let q = get(&found.q, i);
            let (to, r2, ..) = connection(get(&r.x, i), Vec3::ZERO, q, Vec3::ZERO);
            found.put(i, r.kind[i] == kind::POINT, to, r2 * r.probability[i], [q, Vec3::ZERO]);
        }
    }
    if kinds & kind::PARALLEL != 0 {
        for i in 0..LANES {
            let to = get(&found.q, i);
            let q = scene.beyond(get(&r.x, i), to);
            found.put(i, r.kind[i] == kind::PARALLEL, to, r.probability[i], [q, Vec3::ZERO]);
        }
    }
    if kinds & kind::SKY != 0 {
        for i in 0..LANES {
            let to = environment::uniform(r.u(i));
            let q = scene.beyond(get(&r.x, i), to);
            found.put(i, r.kind[i] == kind::SKY, to, r.sky[i] * r.probability[i], [q, Vec3::ZERO]);
        }
    }
}

#[inline(always)]
fn points_of_balls(scene: &Scene, r: &Receivers, found: &mut Found) {
    let (mut numbers, mut prim) = ([[0.0; LANES]; Ball::NUMBERS], [0; LANES]);
    for i in 0..LANES {
        let row = scene.lights.row(r.light[i]);
        (numbers[0][i], numbers[1][i], numbers[2][i]) = row.center.into();
        (numbers[3][i], numbers[4][i], prim[i]) = (row.radius, 1.0 / row.radius, row.prim);
    }
    let mut inside = 0;
    for i in 0..LANES {
        let is = r.kind[i] == kind::BALL;
        let ball = Ball::around(std::array::from_fn(
            #[inline(always)]
            |k| numbers[k][i],
        ));
        let x = get(&r.x, i);
        let (p, pdf, outside) = cone::point(x, ball.center(), ball.radius(), r.u(i));
        let n = ball.normal(p);
        let (to, r2, ..) = connection(x, Vec3::ZERO, p, n);
        // rounding must not let a convex light illuminate itself, nor choose the receiver as the point
        let other = (prim[i] != r.side[i] / 2) & (r2 > 0.0);
        found.put(i, is, to, if other { pdf * r.probability[i] } else { 0.0 }, [p, n]);
        inside |= u32::from(is & !outside);
    }
    if inside == 0 {
        return;
    }
    for (i, &prim) in prim.iter().enumerate() {
        let (row, x) = (scene.lights.row(r.light[i]), get(&r.x, i));
        if r.kind[i] == kind::BALL && prim != r.side[i] / 2 && cone::pdf(x, row.center, row.radius) == 0.0 {
            let point = scene.by_area(x, prim, r.u(i));
            found.put(i, true, point.to, point.pdf, [point.state.p, point.state.n]);
        }
    }
}

/// Points of other surfaces, uniform by area: parallelograms and triangles together, other forms lane by lane.
#[inline(always)]
fn points_of_surfaces(scene: &Scene, r: &Receivers, found: &mut Found) {
    let (mut numbers, mut density) = ([ZERO; Flat::SPAN], ZERO);
    let (mut flat, mut triangle) = ([false; LANES], [false; LANES]);
    for i in 0..LANES {
        if r.kind[i] == kind::SURFACE
            && let Some(prim) = scene.lights.primitive(r.light[i], r.u[1][i])
        {
            density[i] = scene.lights.density[prim as usize];
            let span = match &scene.accel.shapes[prim as usize] {
                Shape::Flat(s) => {
                    flat[i] = true;
                    s.span()
                }
                Shape::Triangle(s) => {
                    triangle[i] = true;
                    s.span()
                }
                _ => {
                    let point = scene.by_area(get(&r.x, i), prim, r.u(i));
                    found.put(i, true, point.to, point.pdf, [point.state.p, point.state.n]);
                    continue;
                }
            };
            numbers.iter_mut().zip(span).for_each(|(lane, x)| lane[i] = x);
        }
    }
    for i in 0..LANES {
        let span: [f32; Flat::SPAN] = std::array::from_fn(
            #[inline(always)]
            |k| numbers[k][i],
        );
        let (one, other) = (Flat::spanned(span), Triangle::spanned(span));
        let (p, n) = (if triangle[i] { other.point(r.u(i)) } else { one.point(r.u(i)) }, one.normal());
        let (to, r2, _, cos) = connection(get(&r.x, i), Vec3::ZERO, p, n);
        found.put(i, flat[i] | triangle[i], to, solid_angle(density[i], r2, cos), [p, n]);
    }
}

/// Points of a sky with an image, and their radiances.
#[inline(always)]
fn points_of_sky(scene: &Scene, r: &Receivers, found: &mut Found) {
    for i in 0..LANES {
        if r.kind[i] == kind::IMAGE {
            let (to, density) = scene.sky_sample(r.u(i));
            let (x, pdf) = (get(&r.x, i), density * r.probability[i]);
            found.put(i, true, to, pdf, [scene.beyond(x, to), Vec3::ZERO]);
            put(&mut found.radiance, i, scene.light(&Vertex::escaped(x, to)));
        }
    }
}

/// Uniform points of a lamp of one primitive, for the first `m` places of a sorted wave with the points `x`, from the last two
/// columns of random numbers: direction, density per solid angle, position and normal, by place.
#[pulp::with_simd(lamp_points = pulp::Arch::new())]
#[inline(always)]
fn lamp_points_with_simd<'a, S: pulp::Simd>(
    _simd: S,
    shape: &'a Shape,
    density: f32,
    x: &'a Columns,
    rays: &'a mut Rays,
    m: usize,
) {
    // the kind is chosen here and not for each point, so that the loops inside have no branch
    match shape {
        Shape::Flat(s) => points(
            #[inline(always)]
            |u| (s.point(u), s.normal()),
            density,
            x,
            rays,
            m,
        ),
        other => points(
            #[inline(always)]
            |u| {
                let p = other.point(u);
                (p, other.normal(p))
            },
            density,
            x,
            rays,
            m,
        ),
    }
}

#[inline(always)]
fn points(point: impl Fn([f32; 2]) -> (Vec3, Vec3), density: f32, x: &Columns, rays: &mut Rays, m: usize) {
    for place in (0..m).step_by(LANES) {
        let list = paths(&rays.order, place, m);
        let (at, u, v) = (gather3(x, &list), gather(&rays.u[2], &list), gather(&rays.u[3], &list));
        let (mut to, mut q, mut n, mut pdf) = (ZERO3, ZERO3, ZERO3, ZERO);
        for lane in 0..LANES {
            let (p, normal) = point([u[lane], v[lane]]);
            let (d, r2, _, cos) = connection(get(&at, lane), Vec3::ZERO, p, normal);
            pdf[lane] = solid_angle(density, r2, cos);
            put(&mut to, lane, d);
            put(&mut q, lane, p);
            put(&mut n, lane, normal);
        }
        store3(&mut rays.to, place, &to);
        store3(&mut rays.q, place, &q);
        store3(&mut rays.m, place, &n);
        store(&mut rays.t, place, &pdf);
    }
}
