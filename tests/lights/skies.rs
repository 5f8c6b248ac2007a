//! Skies: directions have the density they claim, texels their directions, and surfaces the light of closed forms.

use super::*;

/// Bins of the sphere: equal steps of θ and of the azimuth φ.
const ROWS: usize = 16;
const COLUMNS: usize = 32;
/// Cells per bin and axis for integrals.
const FINE: usize = 8;

fn bin(d: Vec3) -> usize {
    let d = d.as_dvec3();
    let (v, u) = (d.y.clamp(-1.0, 1.0).acos() / PI, 0.5 + d.x.atan2(-d.z) / TAU);
    let cell = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
    cell(v, ROWS) * COLUMNS + cell(u, COLUMNS)
}

/// ∫ f dω over each bin: f at the centre of cells, times their solid angle.
fn integrate(rows: usize, columns: usize, fine: usize, f: impl Fn(Vec3) -> DVec3) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; rows * columns];
    let (step_v, step_u) = (PI / (rows * fine) as f64, TAU / (columns * fine) as f64);
    for j in 0..rows * fine {
        let (theta, phi) = ((j as f64 + 0.5) * step_v, |i: usize| (i as f64 + 0.5) * step_u - PI);
        let solid_angle = 2.0 * theta.sin() * (0.5 * step_v).sin() * step_u;
        for i in 0..columns * fine {
            sums[(j / fine) * columns + i / fine] += f(direction(theta, phi(i)).as_vec3()) * solid_angle;
        }
    }
    sums
}

fn lat_long(size: [u32; 2], texel: impl FnMut(u32) -> DVec3) -> Sky {
    Sky::LatLong(Arc::new(Raster::new(size, (0..size[0] * size[1]).map(texel).map(|t| t.as_vec3()).collect())))
}

/// A sky with contrasts of some hundreds, and black holes.
fn random_sky(size: [u32; 2], noise: &mut Noise) -> Sky {
    lat_long(size, |_| {
        let hole = if noise.uniform() < 0.1 { 0.0 } else { 1.0 };
        hole * DVec3::from([(); 3].map(|()| noise.normal().exp()))
    })
}

/// Everything a sky can be, with a rotation by whole bins.
fn skies(noise: &mut Noise) -> Vec<(&'static str, Environment)> {
    let only = |size, at, colour| lat_long(size, move |i| if i == at { colour } else { DVec3::ZERO });
    let sun = |size, at: u32, noise: &mut Noise| {
        lat_long(size, |i| if i == at { DVec3::new(1e5, 9e4, 8e4) } else { DVec3::splat(0.5 + noise.uniform()) })
    };
    vec![
        ("constant", Environment::new(&Sky::Constant(DVec3::new(1.0, 2.0, 3.0)), 10.0, 2.0)),
        ("black", Environment::new(&lat_long([4, 2], |_| DVec3::ZERO), 0.0, 1.0)),
        ("1 × 1", Environment::new(&lat_long([1, 1], |_| DVec3::ONE), 90.0, 1.0)),
        ("2 × 1", Environment::new(&lat_long([2, 1], |i| DVec3::splat(1.0 + f64::from(i))), 45.0, 1.0)),
        ("a texel at the pole", Environment::new(&only([16, 8], 3, DVec3::new(0.0, 0.0, 7.0)), -11.25, 1.0)),
        ("random", Environment::new(&random_sky([16, 8], noise), 33.75, 0.1)),
        ("random, turned back", Environment::new(&random_sky([8, 16], noise), -7.0 * 360.0 - 90.0, 1.0)),
        ("sun", Environment::new(&sun([16, 8], 37, noise), 0.0, 1.0)),
    ]
}

#[test]
fn skies_are_sampled_as_their_density_says() {
    let mut account = open("skies_are_sampled_as_their_density_says");
    let mut noise = Noise(account.seed());
    for (what, env) in skies(&mut noise) {
        let integral = integrate(ROWS, COLUMNS, FINE, |d| DVec3::splat(env.pdf(d).into()));
        let probabilities: Vec<f64> = integral.iter().map(|p| p.x).collect();
        let total: f64 = probabilities.iter().sum();
        assert!((total - 1.0).abs() < 1e-6, "{what}: ∫ p dω = {total}");
        let mut hits = vec![0; ROWS * COLUMNS];
        for _ in 0..1 << 21 {
            let (d, p) = env.sample(pair(&mut noise));
            assert!(p > 0.0 && env.pdf(d) == p, "{what}: {d} has density {}, claimed {p}", env.pdf(d));
            assert!((d.length() - 1.0).abs() < 3e-7, "{what}: {d}");
            hits[bin(d)] += 1;
        }
        assert_fits(&mut account, what, &hits, &probabilities);
    }
    // without the sine: texels by luminance alone, θ uniform in the texel
    let Sky::LatLong(image) = random_sky([16, 8], &mut noise) else { unreachable!() };
    let env = Environment::new(&Sky::LatLong(image.clone()), 0.0, 1.0);
    let luminance = |t: Vec3| t.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722));
    let table = Table::new(image.size, |column, row| luminance(image.texel(column, row))).unwrap();
    let mut hits = vec![0; ROWS * COLUMNS];
    for _ in 0..1 << 21 {
        let ([column, row], [across, down]) = table.sample(pair(&mut noise));
        let at = |cell: u32, rest: f32| f64::from(cell) + f64::from(rest) + 1e-7;
        hits[bin(direction(at(row, down) * PI / 8.0, at(column, across) * TAU / 16.0 - PI).as_vec3())] += 1;
    }
    let integral = integrate(ROWS, COLUMNS, FINE, |d| DVec3::splat(env.pdf(d).into()));
    let probabilities: Vec<f64> = integral.iter().map(|p| p.x).collect();
    assert_misfits(&mut account, "a sampler without the sine", &hits, &probabilities);
}

#[test]
fn skies_give_their_mean() {
    let mut account = open("skies_give_their_mean");
    let mut noise = Noise(account.seed());
    for (what, env) in skies(&mut noise) {
        let mean = env.mean();
        let quadrature =
            integrate(ROWS, COLUMNS, FINE, |d| env.radiance(d).as_dvec3()).iter().sum::<DVec3>() / (2.0 * TAU);
        assert!((quadrature - mean).abs().cmple(2e-6 * mean).all(), "{what}: {quadrature}, mean {mean}");
        // E[L/p] = 4π mean
        let one = |(d, p): (Vec3, f32)| env.radiance(d).as_dvec3() / f64::from(p) / (2.0 * TAU);
        let sampled = mean_of((0..1 << 21).map(|_| one(env.sample(pair(&mut noise)))));
        account.assert_equivalent(what, &sampled, mean, 0.01 * mean + 1e-9);
        // uniform directions, where a sun does not spoil them
        if !["sun", "a texel at the pole"].contains(&what) {
            let uniform = |noise: &mut Noise| {
                let (y, phi) = (1.0 - 2.0 * noise.uniform(), TAU * noise.uniform());
                env.radiance(direction(y.acos(), phi).as_vec3()).as_dvec3()
            };
            let uniform = mean_of((0..1 << 20).map(|_| uniform(&mut noise)));
            account.assert_equivalent(what, &uniform, mean, 0.02 * mean + 1e-9);
        }
    }
    // without the sine, the mean of the texels
    let env = Environment::new(&lat_long([8, 8], |i| DVec3::splat(f64::from((i / 8) * (i / 8)))), 0.0, 1.0);
    let squares = DVec3::splat((0..8).map(|j| f64::from(j * j)).sum::<f64>() / 8.0);
    let one = |(d, p): (Vec3, f32)| env.radiance(d).as_dvec3() / f64::from(p) / (2.0 * TAU);
    let sampled = mean_of((0..1 << 21).map(|_| one(env.sample(pair(&mut noise)))));
    account.assert_equivalent("squares", &sampled, env.mean(), 0.01 * env.mean());
    account.assert_differs("mean without the sine", &sampled, squares);
}

/// Large images have narrow texels; dark ones lie beside the sun. No direction may cross an edge, whatever the numbers.
#[test]
fn sampled_directions_stay_in_their_texel() {
    let mut noise = Noise(5);
    let [w, h] = [4096, 2048];
    let sky = lat_long([w, h], |_| match noise.bits() % 4 {
        0 => DVec3::ZERO,
        1 => DVec3::splat(1e5),
        _ => DVec3::splat(1e-2 + noise.uniform()),
    });
    let env = Environment::new(&sky, 123.456, 1.0);
    let top = 1.0 - 1.0 / 16_777_216.0;
    let corners = [[0.0, 0.0], [0.0, top], [top, 0.0], [top, top], [0.5, 0.5]];
    for u in corners.into_iter().chain((0..1 << 21).map(|_| pair(&mut noise))) {
        let (d, p) = env.sample(u);
        assert!(p > 0.0 && env.pdf(d) == p && env.radiance(d).min_element() > 0.0, "{u:?}: {d}");
    }
    // a sun takes nearly all numbers, so some of them fall next to its edges: narrow columns, then low rows
    for ([w, h], row) in [([8192, 16], 0), ([8192, 16], 7), ([8192, 16], 15), ([8, 8192], 4000), ([8, 8192], 8191)] {
        let at = row * w + w / 3;
        let env = Environment::new(&lat_long([w, h], |i| DVec3::splat(if i == at { 1e9 } else { 0.01 })), 77.7, 1.0);
        let sun = env.sample([0.5, 0.5]).1;
        for u in corners.into_iter().chain((0..1 << 19).map(|_| pair(&mut noise))) {
            let (d, p) = env.sample(u);
            assert!(env.pdf(d) == p && (p == sun) == (env.radiance(d).x == 1e9), "{w} × {h}, {u:?}: {d}");
        }
    }
}

#[test]
fn skies_hang_the_right_way() {
    // three columns: −z is in the middle of the second; two rows: the first is above
    let sky = lat_long([3, 2], |i| DVec3::splat(f64::from(i + 1)));
    let env = Environment::new(&sky, 0.0, 1.0);
    let at = |env: &Environment, d: DVec3| env.radiance(d.normalize().as_vec3()).x;
    for (d, value) in [(DVec3::NEG_Z, 2.0), (DVec3::new(1.0, 0.0, 0.1), 3.0), (DVec3::new(-1.0, 0.0, 0.1), 1.0)] {
        assert_eq!([at(&env, d + 0.1 * DVec3::Y), at(&env, d - 0.1 * DVec3::Y)], [value, value + 3.0], "{d}");
    }
    // one bright column turns with the sky, counter-clockwise seen from +y
    let bright = lat_long([8, 4], |i| if i % 8 == 5 { DVec3::ONE } else { DVec3::ZERO });
    let home = direction(1.1, TAU * (5.5 / 8.0 - 0.5));
    for turn in [0.0, 45.0, 90.0, 137.0, -60.0, 400.0] {
        let (env, about) = (Environment::new(&bright, turn, 3.0), DQuat::from_rotation_y(f64::to_radians(turn)));
        assert_eq!(at(&env, about * home), 3.0, "{turn}");
        assert_eq!(at(&env, about.inverse() * home), if turn == 0.0 { 3.0 } else { 0.0 }, "{turn}");
        let mut noise = Noise(1);
        for _ in 0..1000 {
            let d = about.inverse() * env.sample(pair(&mut noise)).0.as_dvec3();
            let u = 0.5 + d.x.atan2(-d.z) / TAU;
            assert!((5.0 / 8.0..6.0 / 8.0).contains(&u), "{turn}: {u}");
        }
    }
}

#[test]
fn a_quadratic_sky_lights_a_surface_in_closed_form() {
    let mut account = open("a_quadratic_sky_lights_a_surface_in_closed_form");
    let mut noise = Noise(account.seed());
    let truth = case("direct", "direct_env_quadratic");
    let (rho, axis) = (truth.number("rho"), DVec3::new(2.0, -1.0, 2.0) / 3.0);
    let [w, h] = [512, 256];
    let centre = |i: u32| {
        let at = |cell: u32, n: u32| (f64::from(cell) + 0.5) / f64::from(n);
        direction(PI * at(i / w, h), TAU * (at(i % w, w) - 0.5))
    };
    let env = Environment::new(&lat_long([w, h], |i| DVec3::splat(centre(i).dot(axis).powi(2))), 0.0, 1.0);
    let across = axis.any_orthonormal_vector();
    for (cosine, radiance) in truth.list("n_dot_u").into_iter().zip(truth.list("T1")) {
        let n = cosine * axis + (1.0 - cosine * cosine).sqrt() * across;
        let lit = |d: Vec3| rho / PI * env.radiance(d).as_dvec3() * n.dot(d.as_dvec3()).max(0.0);
        let quadrature = integrate(h as usize, w as usize, 3, lit).iter().sum::<DVec3>();
        assert!((quadrature - radiance).abs().max_element() < 2e-5, "{cosine}: {quadrature}, truth {radiance}");
        let one = |(d, p): (Vec3, f32)| lit(d) / f64::from(p);
        let sampled = mean_of((0..1 << 20).map(|_| one(env.sample(pair(&mut noise)))));
        let what = format!("n·u = {cosine}");
        account.assert_equivalent(&what, &sampled, DVec3::splat(radiance), DVec3::splat(0.02 * radiance));
    }
}

/// A photograph of a mirror sphere under a known sky shows that sky, but for the blind spot.
#[test]
fn mirror_balls_show_the_sky_around_them() {
    let sky = |d: DVec3| DVec3::new(1.0 + 0.5 * d.x, 1.0 + 0.5 * d.y * d.z, 1.0 - 0.4 * d.z + 0.3 * d.x * d.y);
    let size = 256;
    // each pixel is the mean of what its inside sees of the sphere
    let photo = |normal: fn(f64, f64) -> DVec3| {
        let pixel = |i: u32| {
            let (mut sum, mut seen) = (DVec3::ZERO, 0.0);
            for k in 0..64 {
                let at =
                    |cell: u32, k: u32| 2.0 * (f64::from(cell) + (f64::from(k) + 0.5) / 8.0) / f64::from(size) - 1.0;
                let (x, y) = (at(i % size, k % 8), -at(i / size, k / 8));
                if x * x + y * y < 1.0 {
                    let n = normal(x, y);
                    (sum, seen) = (sum + sky(2.0 * n.z * n - DVec3::Z), seen + 1.0);
                }
            }
            if seen > 0.0 { (sum / seen).as_vec3() } else { Vec3::ZERO }
        };
        Sky::MirrorBall(Arc::new(Raster::new([size; 2], (0..size * size).map(pixel).collect())))
    };
    let error = |photo: &Sky, blind: f64| {
        let env = Environment::new(photo, 0.0, 1.0);
        let keep = |d: Vec3| f64::from(u8::from(f64::from(-d.z).acos() > blind));
        let area: DVec3 = integrate(64, 128, 2, |d| DVec3::splat(keep(d))).iter().sum();
        let square = |d: Vec3| keep(d) * (env.radiance(d).as_dvec3() - sky(d.as_dvec3())).powf(2.0);
        (integrate(64, 128, 2, square).iter().sum::<DVec3>() / area).max_element().sqrt()
    };
    let upright = |x: f64, y: f64| DVec3::new(x, y, (1.0 - x * x - y * y).sqrt());
    let blind = 2.0 * (6.0 / f64::from(size)).sqrt();
    let right = photo(upright);
    let (seen, all) = (error(&right, blind), error(&right, 0.0));
    assert!(seen < 4e-3, "rms error {seen}");
    assert!(all < 2e-2, "rms error {all} with the blind spot");
    let flipped = photo(|x, y| DVec3::new(-x, y, (1.0 - x * x - y * y).sqrt()));
    // the sphere as a map of directions instead of normals
    let direct = photo(|x, y| (DVec3::new(x, y, (1.0 - x * x - y * y).sqrt()) + DVec3::Z).normalize());
    for (what, wrong) in [("flipped", flipped), ("normals taken for directions", direct)] {
        let wrong = error(&wrong, blind);
        assert!(wrong > 0.1, "{what}: {wrong}");
    }
}
