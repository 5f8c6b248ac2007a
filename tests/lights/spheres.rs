//! Spheres: uniform in the solid angle they are seen under, far away and close by.

use super::*;

/// Points to see a sphere from: radius, centre, distance in radii.
const VIEWS: [(f32, Vec3, f64); 4] = [
    (1.0, Vec3::new(0.25, -0.5, 0.125), 1.001),
    (0.5, Vec3::new(1.0, 2.0, 3.0), 2.0),
    (2.0, Vec3::new(-3.0, 0.0, 1.0), 10.0),
    (0.125, Vec3::ZERO, 1e4),
];

fn view((radius, center, distance): (f32, Vec3, f64)) -> Vec3 {
    (center.as_dvec3() + DVec3::new(2.0, -3.0, 6.0) / 7.0 * distance * f64::from(radius)).as_vec3()
}

/// (1 − cos θ)/(1 − cos θ_max) and the azimuth in turns of the direction from `from` to `p`, about the centre's.
fn in_cone(from: Vec3, center: Vec3, radius: f32, p: DVec3) -> [f64; 2] {
    let axis = center.as_dvec3() - from.as_dvec3();
    let d = (p - from.as_dvec3()).normalize();
    let haversine = |sin2: f64| sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt());
    let x =
        haversine(axis.normalize().cross(d).length_squared()) / haversine((f64::from(radius) / axis.length()).powi(2));
    let (t, b) = axis.normalize().any_orthonormal_pair();
    [x, 0.5 + d.dot(b).atan2(d.dot(t)) / TAU]
}

#[test]
fn spheres_are_sampled_uniformly_in_solid_angle() {
    let mut account = open("spheres_are_sampled_uniformly_in_solid_angle");
    let mut noise = Noise(account.seed());
    const BINS: usize = 16;
    let bin = |[x, turn]: [f64; 2]| {
        let cell = |x: f64| ((x * BINS as f64) as usize).min(BINS - 1);
        cell(x) * BINS + cell(turn)
    };
    let uniform = vec![1.0 / (BINS * BINS) as f64; BINS * BINS];
    for (i, case) in VIEWS.into_iter().enumerate() {
        let ((radius, center, distance), from) = (case, view(case));
        let mut hits = vec![0; BINS * BINS];
        for _ in 0..1 << 20 {
            let (p, density) = cone::sample(from, center.as_dvec3(), f64::from(radius), pair(&mut noise)).unwrap();
            assert_eq!(density, cone::pdf(from, center.as_dvec3(), f64::from(radius)));
            let n = p.as_dvec3() - center.as_dvec3();
            assert!((n.length() / f64::from(radius) - 1.0).abs() < 3e-6, "{distance}: {p}");
            // on the near side, up to the rounding of the point
            let cosine = n.normalize().dot((from.as_dvec3() - p.as_dvec3()).normalize());
            assert!(cosine > -2e-3, "{distance}: cosine {cosine}");
            let at = in_cone(from, center, radius, p.as_dvec3());
            assert!(at[0] < 1.0 + 1e-5, "{distance}: {at:?}");
            hits[bin(at)] += 1;
        }
        assert_fits(&mut account, &format!("distance {distance}"), &hits, &uniform);
        if i < 2 {
            // ∫ p dω = 1: directions uniform over the sphere hit with probability 1/4πp
            let towards = |noise: &mut Noise| direction((1.0 - 2.0 * noise.uniform()).acos(), TAU * noise.uniform());
            let axis = center.as_dvec3() - from.as_dvec3();
            let cos_max = (1.0 - (f64::from(radius) / axis.length()).powi(2)).sqrt();
            let trials = 1 << 20;
            let meets = |d: DVec3| d.dot(axis.normalize()) > cos_max;
            let found = (0..trials).filter(|_| meets(towards(&mut noise))).count() as u64;
            let share = 1.0 / (2.0 * TAU * f64::from(cone::pdf(from, center.as_dvec3(), f64::from(radius))));
            assert_rate(&mut account, "the solid angle", found, trials, share);
        }
    }
    // points uniform on the disk of the same radius through the centre
    let ((radius, center, _), from) = (VIEWS[1], view(VIEWS[1]));
    let (t, b) = (center - from).as_dvec3().normalize().any_orthonormal_pair();
    let mut hits = vec![0; BINS * BINS];
    for _ in 0..1 << 20 {
        let (r, phi) = (f64::from(radius) * noise.uniform().sqrt(), TAU * noise.uniform());
        let (sin, cos) = phi.sin_cos();
        hits[bin(in_cone(from, center, radius, center.as_dvec3() + r * (cos * t + sin * b)))] += 1;
    }
    assert_misfits(&mut account, "a disk", &hits, &uniform);
}

/// The irradiance of a sphere of radiance 1 wholly above the horizon is π(r/d)² cos, whatever its size.
#[test]
fn a_sphere_above_the_horizon_is_a_point_light() {
    let mut account = open("a_sphere_above_the_horizon_is_a_point_light");
    let mut noise = Noise(account.seed());
    let radius = 0.75f32;
    for (distance, cosine) in [(1.05, 1.0f64), (1.5, 0.8), (2.0, 0.5), (10.0, 0.3), (1e3, 0.1)] {
        let d = distance * f64::from(radius);
        let center = (DVec3::new((1.0 - cosine * cosine).sqrt(), cosine, 0.0) * d).as_vec3();
        let one = |u| {
            let (p, density) = cone::sample(Vec3::ZERO, center.as_dvec3(), f64::from(radius), u).unwrap();
            DVec3::splat(p.as_dvec3().normalize().y / f64::from(density))
        };
        let sampled = mean_of((0..1 << 20).map(|_| one(pair(&mut noise))));
        let truth = DVec3::splat(PI * cosine / (distance * distance));
        account.assert_equivalent(&format!("distance {distance}"), &sampled, truth, 0.005 * truth);
        if distance == 1.5 {
            // with the density of the disk through the centre, r/d as if it were far
            let disk = (d * d / (PI * f64::from(radius).powi(2))) as f32;
            let ratio = f64::from(cone::pdf(Vec3::ZERO, center.as_dvec3(), f64::from(radius)) / disk);
            let wrong = mean_of((0..1 << 16).map(|_| one(pair(&mut noise)) * ratio));
            account.assert_differs("the density of a disk", &wrong, truth);
        }
    }
}

#[test]
fn cones_keep_their_digits_far_away_and_close_by() {
    for (radius, center) in [(1e-3f32, Vec3::new(3e3, -4e3, 1e3)), (1.0, Vec3::new(0.0, 0.0, 1e6)), (1e-6, Vec3::X)] {
        let far = center.as_dvec3().length_squared() / (PI * f64::from(radius).powi(2));
        let pdf = f64::from(cone::pdf(Vec3::ZERO, center.as_dvec3(), f64::from(radius)));
        assert!((pdf / far - 1.0).abs() < 1e-6, "{pdf} for {far}");
    }
    // half the sphere of directions at the surface: p → 1/2π, and cos θ_max = √(d² − r²)/d to the last digit on the way
    for k in [1, 8, 16, 23] {
        let gap = 0.5f64.powi(k);
        let from = Vec3::new(0.0, 1.0 + gap as f32, 0.0);
        let exact = 1.0 / (TAU * (1.0 - (gap * (2.0 + gap)).sqrt() / (1.0 + gap)));
        assert!((f64::from(cone::pdf(from, DVec3::ZERO, 1.0)) / exact - 1.0).abs() < 1e-6, "2^-{k}");
        for u in [[0.0, 0.0], [0.0, 0.9], [1.0 - f32::EPSILON / 2.0, 0.3], [0.5, 0.5]] {
            let (p, density) = cone::sample(from, DVec3::ZERO, 1.0, u).unwrap();
            assert!(p.is_finite() && density.is_finite() && (p.length() - 1.0).abs() < 1e-6, "2^-{k}, {u:?}: {p}");
        }
    }
    // u = 0 is the nearest point
    let (p, _) = cone::sample(Vec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 2.0, [0.0, 0.0]).unwrap();
    assert!((p - Vec3::new(0.0, 0.0, 2.0)).length() < 1e-6);
    for from in [Vec3::ZERO, Vec3::X, Vec3::new(0.6, 0.0, 0.0)] {
        assert!(cone::sample(from, DVec3::ZERO, 1.0, [0.5; 2]).is_none(), "{from}");
        assert_eq!(cone::pdf(from, DVec3::ZERO, 1.0), 0.0);
    }
}
