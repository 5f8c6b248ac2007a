//! One path, every way to find it: `value · p_s = F` and `weight = p_s / Σ p_r`, with the right-hand sides written down once more.

use super::plain::{Node, PathDensities, walk};
use super::*;

/// A path and its scene, for the plain formulas: positions, unit normals (either side), where it is.
struct Reference<'a> {
    scene: &'a Scene,
    description: &'a Description,
    /// The sky alone.
    sky: Option<Environment>,
    /// Radius of what parallel light must cover.
    radius: f64,
    lights: f64,
}

impl<'a> Reference<'a> {
    fn new(scene: &'a Scene, description: &'a Description) -> Self {
        let bounds = description.primitives().into_iter().map(|(_, p)| p.bounds());
        let [low, high] = bounds.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let sky = description.lights.iter().find_map(|l| match l {
            LightDescription::Environment { sky, rotate, scale } => Some(Environment::new(sky, *rotate, *scale)),
            _ => None,
        });
        let lights = description.lights.len() + description.shapes.iter().filter(|s| s.emission != DVec3::ZERO).count();
        Self { scene, description, sky, radius: 0.5 * (high - low).length(), lights: lights as f64 }
    }

    /// Whether light from there is parallel.
    fn parallel(&self, v: &Vertex) -> bool {
        v.side == ESCAPED
            || v.side >= LIGHT && {
                let without_surface = (v.side - LIGHT) as usize + self.description.lights.len() - self.lights as usize;
                matches!(self.description.lights[without_surface], LightDescription::Directional { .. })
            }
    }

    fn direction(&self, from: &Vertex, to: &Vertex) -> DVec3 {
        if self.parallel(to) { -to.omega.as_dvec3() } else { (to.p.as_dvec3() - from.p.as_dvec3()).normalize() }
    }

    /// dω/dμ(to): |cos|/r² of a surface, 1 of the sky, 0 of what no ray hits.
    fn angle(&self, from: &Vertex, to: &Vertex) -> f64 {
        match to.side {
            ESCAPED => 1.0,
            side if side < LIGHT => self.cosine(to, self.direction(from, to)) / self.r2(from, to),
            _ => 0.0,
        }
    }

    fn r2(&self, a: &Vertex, b: &Vertex) -> f64 {
        (b.p.as_dvec3() - a.p.as_dvec3()).length_squared()
    }

    fn cosine(&self, v: &Vertex, d: DVec3) -> f64 {
        v.n.as_dvec3().dot(d).abs()
    }

    /// The BSDF on the side of `before`, and the local directions.
    fn local(&self, before: DVec3, at: &Vertex, after: DVec3) -> (Bsdf, Vec3, Vec3) {
        let flip = at.n.as_dvec3().dot(before) < 0.0;
        let seen = if flip { Vertex { n: -at.n, side: at.side ^ 1, ..*at } } else { *at };
        let frame = Frame::new(seen.n);
        (self.scene.bsdf(&seen), frame.local(before.as_vec3()), frame.local(after.as_vec3()))
    }

    /// Scattering at `at` from the direction `wo` to `wi`: f |cos|, and its density in solid angle. A delta part stands for
    /// its factor of the delta function of n² times projected solid angle, which is the same from both ends.
    fn scatter(&self, wo: DVec3, at: &Vertex, wi: DVec3, delta: bool) -> (DVec3, f64) {
        let (bsdf, o, i) = self.local(wo, at, wi);
        if !delta {
            let f = bsdf.eval(o, i, TransportMode::Radiance).as_dvec3() * f64::from(i.z.abs());
            return (f, f64::from(bsdf.pdf(o, i, Sampling::Bsdf)));
        }
        let draws = [0.0, 1.0 - f32::EPSILON / 2.0]
            .map(|u| bsdf.sample(o, Sampling::Bsdf, TransportMode::Radiance, [0.5, 0.5, u]));
        let s = draws.into_iter().flatten().find(|s| s.delta && (s.wi.z > 0.0) == (i.z > 0.0)).unwrap();
        let relative = match bsdf {
            Bsdf::Dielectric(fredholm::scene::bsdf::dielectric::Dielectric::Smooth(d)) if i.z < 0.0 => {
                f64::from(d.interface.eta)
            }
            _ => 1.0,
        };
        let density = f64::from(s.pdf) * self.cosine(at, wi) * relative;
        (s.weight.as_dvec3() * density, density)
    }

    /// Density with which light starts at z.
    fn emit(&self, z: &Vertex) -> f64 {
        match z.side {
            ESCAPED => self.sky.as_ref().map_or(0.0, |s| f64::from(s.pdf(-z.omega))) / self.lights,
            side if side >= LIGHT => 1.0 / self.lights,
            side => {
                let (shape, _) = self.description.primitives()[(side / 2) as usize];
                let mine = self.description.primitives().into_iter().filter(|(s, _)| *s == shape);
                let area: f64 = mine.map(|(_, p)| p.area()).sum();
                let shines = side & 1 == 0 && self.description.shapes[shape].emission != DVec3::ZERO;
                if shines { 1.0 / (area * self.lights) } else { 0.0 }
            }
        }
    }

    /// Density with which next-event estimation at x chooses z.
    fn connect(&self, x: &Vertex, z: &Vertex) -> f64 {
        if z.side < LIGHT && self.emit(z) > 0.0 {
            let (shape, primitive) = self.description.primitives()[(z.side / 2) as usize];
            let whole = matches!(self.description.shapes[shape].geometry, Geometry::Sphere { inward: false, .. });
            if let (Primitive::Sphere { center, radius, z: [-1.0, 1.0], .. }, true) = (primitive, whole) {
                let sin2 = radius * radius / (center - x.p.as_dvec3()).length_squared();
                if sin2 < 1.0 {
                    let one_minus_cos = sin2 / (1.0 + (1.0 - sin2).sqrt());
                    return self.angle(x, z) / (2.0 * PI * one_minus_cos * self.lights);
                }
            }
        }
        self.emit(z)
    }

    /// Emission with its cosine, and the density of light that starts at z going to x, in the measure of x.
    fn shine(&self, z: &Vertex, x: &Vertex) -> (DVec3, f64) {
        let to = if self.parallel(z) { z.omega.as_dvec3() } else { self.direction(z, x) };
        let light = self.scene.light(z).as_dvec3();
        if z.side < LIGHT {
            let cos = z.n.as_dvec3().dot(to).max(0.0);
            return (light * cos, cos / PI * self.angle(z, x));
        }
        let arrives = self.cosine(x, to);
        let density = if self.parallel(z) {
            arrives / (PI * self.radius * self.radius)
        } else {
            arrives / (4.0 * PI * self.r2(z, x))
        };
        (light, density)
    }

    /// F and p_0 … p_{k+1}; None where a cosine or a distance is so small that `f32` has lost it.
    fn path(&self, z: &[Vertex], delta: &[bool]) -> Option<(DVec3, Vec<f64>)> {
        let k = z.len() - 1;
        let c = &self.description.camera;
        let eye = Vertex { p: c.origin.as_vec3(), ..Vertex::default() };
        let after = |i: usize| self.direction(&z[i], &z[i + 1]);
        let before = |i: usize| if i == 0 { self.direction(&z[0], &eye) } else { self.direction(&z[i], &z[i - 1]) };
        let conditioned = |i: usize| {
            let cosines = i == k || self.cosine(&z[i], after(i)) > 0.03 && self.cosine(&z[i], before(i)) > 0.03;
            let light = i < k || z[i].side >= LIGHT || self.cosine(&z[i], before(i)) > 0.03;
            let close = i == 0 || self.parallel(&z[i]) || self.r2(&z[i - 1], &z[i]) > 0.01;
            cosines && light && close
        };
        if !(0..=k).all(conditioned) {
            return None;
        }
        // the camera: uniform in the plane of the image
        let seen = if self.parallel(&z[0]) { -z[0].omega.as_dvec3() } else { self.direction(&eye, &z[0]) };
        let pixel = 2.0 * (0.5 * c.fov).to_radians().tan() / f64::from(c.size[0]);
        let cos = seen.dot((c.target - c.origin).normalize());
        let share = 1.0 / f64::from(c.size[0] * c.size[1]);
        let from_camera = share / (pixel * pixel * cos.powi(3)) * self.angle(&eye, &z[0]);

        // both directions of every step
        let (mut from_eye, mut from_light) = (vec![from_camera], vec![0.0; k + 1]);
        let mut f = DVec3::splat(from_camera);
        for i in 0..k {
            let (value, density) = self.scatter(before(i), &z[i], after(i), delta[i]);
            from_eye.push(density * self.angle(&z[i], &z[i + 1]));
            // a point is reached by 1/r², a direction by 1
            let reached = match z[i + 1].side {
                side if side >= LIGHT && self.parallel(&z[i + 1]) => 1.0,
                side if side >= LIGHT => 1.0 / self.r2(&z[i], &z[i + 1]),
                _ => self.angle(&z[i], &z[i + 1]),
            };
            f *= value * reached;
            if i > 0 {
                let (_, density) = self.scatter(after(i), &z[i], before(i), delta[i]);
                from_light[i - 1] = density * self.angle(&z[i], &z[i - 1]);
            }
        }
        f *= self.scene.light(&z[k]).as_dvec3();
        from_light[k] = self.emit(&z[k]);
        if k > 0 {
            from_light[k - 1] = self.shine(&z[k], &z[k - 1]).1;
        }
        let density = |s: usize| {
            let t = k + 1 - s;
            if s > 0 && (delta[t] || t > 0 && delta[t - 1]) {
                return 0.0;
            }
            let light: f64 =
                if s == 1 && t > 0 { self.connect(&z[k - 1], &z[k]) } else { from_light[t..].iter().product() };
            from_eye[..t].iter().product::<f64>() * light
        };
        Some((f, (0..=k + 1).map(density).collect()))
    }
}

/// A path that was found: its way, states, delta vertices, value, densities and weight.
struct Find {
    s: usize,
    path: Vec<Vertex>,
    delta: Vec<bool>,
    value: Rgb,
    weight: f32,
    densities: PathDensities,
}

/// The stream that light is followed with, as the estimators have it.
const LIGHT_STREAM: u32 = 0x4c49_4748;

/// Everything one pair of walks finds, with the paths themselves: the strategies of `Bidirectional` once more, one path at a time.
fn finds(t: &SceneTransport, key: Key, pixel: u32, sample: u32, last: usize) -> Vec<Find> {
    let sensor = &t.scene.camera;
    let share = 1.0 / (sensor.size[0] * sensor.size[1]) as f32;
    let numbers = |key: Key| move |v: usize, purpose: Purpose| Rng::at(key, pixel, sample, v, purpose);
    let (eye_numbers, light_numbers) = (numbers(key), numbers(key.branch(LIGHT_STREAM)));
    let (mut eye, mut light) = (vec![], vec![]);
    if let Some(start) = sensor.start(t, pixel, &mut eye_numbers(0, Purpose::Start)) {
        eye.push(Node::new(start, Rgb::ONE, sensor.density(t, &start) * share));
        walk(t, &mut eye, last, Role::Radiance, |v| eye_numbers(v, Purpose::Scatter), |_| ());
    }
    if let Some((start, density)) = t.emit(&mut light_numbers(0, Purpose::Start)) {
        light.push(Node::new(start, Rgb::splat(1.0 / density), density));
        walk(t, &mut light, last, Role::Emission, |v| light_numbers(v, Purpose::Scatter), |_| ());
    }
    let mut all = vec![];
    let mut find = |eye: &[Node<Vertex>], light: &[Node<Vertex>], seen: Option<(Vertex, f32)>, value: Rgb| {
        let nodes = || eye.iter().chain(light.iter().rev());
        let mut delta: Vec<bool> = nodes().map(|n| n.delta.is_some()).collect();
        // the vertices that are linked scatter by what is no delta part
        let t_ = eye.len();
        [t_.checked_sub(1), (t_ < delta.len()).then_some(t_)].into_iter().flatten().for_each(|i| delta[i] = false);
        let densities = PathDensities::new(t, eye, light, seen);
        let weight = densities.weight(false);
        all.push(Find { s: light.len(), path: nodes().map(|n| n.state).collect(), delta, value, weight, densities });
    };
    for (k, x) in eye.iter().enumerate() {
        let e = t.emission(&x.state);
        if e != Rgb::ZERO {
            find(&eye[..=k], &[], None, x.throughput * e);
        }
    }
    for (v, x) in eye.iter().take(last).enumerate() {
        if let Some(c) = t.connect(&x.state, &mut eye_numbers(v, Purpose::Connect)) {
            let y = Node::new(c.state, Rgb::ONE, t.emit_density(&c.state));
            find(&eye[..=v], &[y], None, x.throughput * c.weight * t.emission(&c.state));
        }
    }
    for (i, x) in eye.iter().enumerate() {
        for (j, y) in light.iter().enumerate().skip(1).take(last.saturating_sub(i + 1)) {
            let here = t.toward(&x.state, &y.state, Role::Radiance).value;
            let value = x.throughput * here * t.toward(&y.state, &x.state, Role::Flux).value * y.throughput;
            let link = if value == Rgb::ZERO { 0.0 } else { t.link(&x.state, &y.state) };
            if link > 0.0 {
                find(&eye[..=i], &light[..=j], None, value * link);
            }
        }
    }
    for (k, y) in light.iter().enumerate() {
        let Some(seen) = sensor.project(t, &y.state) else { continue };
        let role = if k == 0 { Role::Emission } else { Role::Flux };
        let value = y.throughput * t.toward(&y.state, &seen.eye, role).value * seen.importance;
        if value != Rgb::ZERO && sensor.sees(t, &y.state) {
            find(&[], &light[..=k], Some((seen.eye, seen.density * share)), value * share);
        }
    }
    all
}

/// How many paths of each kind were compared, and the errors.
#[derive(Default)]
struct Compared {
    errors: Vec<f64>,
    ways: [usize; 7],
    delta: usize,
    refracted: usize,
    sky: usize,
    point: usize,
    beam: usize,
}

fn compare_paths(d: &Description, seed: u64, samples: u32, seen: &mut Compared) {
    const LAST: usize = 5;
    let scene = Scene::new(d);
    let t = SceneTransport::new(&scene);
    let centred = d.centred().scene;
    let reference = Reference::new(&scene, &centred);
    let (key, pixels) = (Key::new(seed, "paths"), scene.camera.size[0] * scene.camera.size[1]);
    let bidirectional = Bidirectional(plan(LAST, Technique::Mis, &Roulette::Never));
    for (pixel, sample) in (0..pixels).flat_map(|p| (0..samples).map(move |s| (p, s))) {
        let finds = finds(&t, key, pixel, sample, LAST);
        // the estimator finds just these, with weights that are equal to rounding
        let mut theirs = vec![];
        let batch = &Batch { key, pixels: pixel..pixel + 1, samples: sample..sample + 1 };
        let job = Job { t: &t, sensor: &scene.camera, batch };
        let mut add = |f: &mut Found| {
            for i in 0..f.pixel.len() {
                theirs.push((f.s, f.k, f.value.get(i), f.weight[i]));
            }
        };
        bidirectional.find(&job, &mut add, |_, _| ());
        theirs.retain(|f| f.2 != Rgb::ZERO);
        theirs.sort_by_key(|f| (f.0, f.1));
        let ours = finds.iter().filter(|f| f.value != Rgb::ZERO);
        let mut ours: Vec<_> = ours.map(|f| (f.s, f.path.len() - 1, f.value, f.weight)).collect();
        ours.sort_by_key(|f| (f.0, f.1));
        assert!(ours.iter().all(|f| f.2.is_finite() && f.3.is_finite()), "scene {seed}: {ours:?}");
        assert_eq!(ours.len(), theirs.len());
        for (a, b) in ours.iter().zip(&theirs) {
            assert_eq!((a.0, a.1, a.2), (b.0, b.1, b.2));
            assert!((a.3 - b.3).abs() <= 1e-6 * a.3, "scene {seed}, s = {}, k = {}: weights {} {}", a.0, a.1, a.3, b.3);
        }

        for f in finds.iter().filter(|f| f.value.min_element() > 1e-20) {
            let Some((contribution, densities)) = reference.path(&f.path, &f.delta) else { continue };
            let material = |v: &Vertex| match v.side {
                side if side < LIGHT => {
                    format!("{:?}", d.materials[d.shapes[d.primitives()[(side / 2) as usize].0].material].bsdf)
                }
                _ => "light".into(),
            };
            let path =
                || f.path.iter().zip(&f.delta).map(|(v, delta)| format!("  {v:?} delta {delta} {}", material(v)));
            let what = || format!("s = {}, scene {seed}\n{}", f.s, path().collect::<Vec<_>>().join("\n"));
            let (sum, mine) = (densities.iter().sum::<f64>(), densities[f.s]);
            assert!(mine > 0.0, "found where it cannot be: {densities:?} {}", what());
            let total = mine / sum;
            let weight_error = (f64::from(f.weight) - total).abs();
            let value_error = (f.value.as_dvec3() * mine / contribution - 1.0).abs().max_element();
            let density_error = (0..densities.len()).map(|r| {
                let q = f.densities.density(r);
                // what never matters may be lost
                if densities[r].max(q) < 1e-6 * sum { 0.0 } else { (q / densities[r] - 1.0).abs() }
            });
            let error = density_error.fold(weight_error.max(value_error), f64::max);
            assert!(
                error < 0.1,
                "weight {} for {total}, value·p/F {}, densities {densities:?} against {:?}, {}",
                f.weight,
                f.value.as_dvec3() * mine / contribution,
                (0..densities.len()).map(|r| f.densities.density(r)).collect::<Vec<_>>(),
                what()
            );
            seen.errors.push(error);
            seen.ways[f.s] += 1;
            let inner = || (1..f.path.len() - 1).filter(|&i| f.delta[i]);
            seen.delta += usize::from(inner().count() > 0);
            let crosses = |i: usize| {
                let n = f.path[i].n.as_dvec3();
                let [a, b] = [i - 1, i + 1].map(|j| n.dot(reference.direction(&f.path[i], &f.path[j])));
                a * b < 0.0
            };
            seen.refracted += usize::from((1..f.path.len().max(2) - 1).any(crosses));
            let z = f.path.last().unwrap();
            seen.sky += usize::from(z.side == ESCAPED);
            seen.beam += usize::from(z.side != ESCAPED && reference.parallel(z));
            seen.point += usize::from(z.side != ESCAPED && z.side >= LIGHT && !reference.parallel(z));
        }
    }
}

#[test]
fn weights_are_those_of_the_path() {
    let mut seen = Compared::default();
    for (i, mut d) in draw(world(), 160).enumerate() {
        d.camera.size = [4, 3];
        compare_paths(&d, i as u64, 12, &mut seen);
    }
    seen.errors.sort_by(f64::total_cmp);
    let at = |q: f64| seen.errors[(q * (seen.errors.len() - 1) as f64) as usize];
    eprintln!(
        "{} paths, ways {:?}, {} with delta vertices, {} refracted, {} from the sky, {} from a point, {} from a direction; \
         errors: median {:.1e}, 99 % {:.1e}, largest {:.1e}",
        seen.errors.len(),
        seen.ways,
        seen.delta,
        seen.refracted,
        seen.sky,
        seen.point,
        seen.beam,
        at(0.5),
        at(0.99),
        at(1.0)
    );
    assert!(at(0.5) < 5e-5 && at(0.99) < 2e-3);
    assert!(seen.ways.iter().all(|&n| n > 300));
    for n in [seen.delta, seen.refracted, seen.sky, seen.point, seen.beam] {
        assert!(n > 300);
    }
}
