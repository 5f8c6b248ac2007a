//! Direct light at single points in closed form.

use super::*;

/// A light that reflects nothing over a floor: T¹ at points of the floor by closed form, and no second bounce at all.
fn direct(jury: &mut Jury, name: &str, light: Geometry, emission: f64, rho: f64, points: &[(DVec3, f64)]) {
    let floor = quad(DVec3::new(-1.5, 11.0, 0.0), DVec3::NEG_Y * 13.0, DVec3::X * 13.0);
    let scene = Scene::new(&description(&[
        (light, DVec3::ZERO, DVec3::splat(emission)),
        (floor, DVec3::splat(rho), DVec3::ZERO),
    ]));
    let starts = Starts(points.iter().map(|&(p, _)| Start::At(point(&scene, p, DVec3::Z))).collect());
    let t = SceneTransport::new(&scene);
    for technique in TECHNIQUES {
        let key = Key::new(jury.seed(), name);
        let film = film(&t, &starts, Kind::Prefix, &plan(4, technique, &Roulette::LECTURE.after(4)), 1 << 17, key);
        for (i, &(p, truth)) in points.iter().enumerate() {
            let (what, truth) = (format!("{name}, {technique}, T1 at {p}"), DVec3::splat(truth));
            let judged = jury.judge(&what, &at(&film, i, 1..2), truth, 0.01 * truth, 0.5 * truth);
            assert!(technique == Technique::Scatter || judged != Judged::TooNoisy, "{what}");
            for slot in [0, 2, 3, 4, 5] {
                assert_eq!(at(&film, i, slot..slot + 1).mean, DVec3::ZERO, "{what}: slot {slot}");
            }
        }
    }
}

#[test]
fn direct_light_is_the_closed_form() {
    let mut jury = Jury::open("direct_light_is_the_closed_form");

    let rect = case("direct", "direct_rect_light");
    let corner = rect.table("light");
    let [a, b, d] = [0, 1, 3].map(|i: usize| DVec3::from_slice(&corner[i]));
    // its normal must point down
    let light = quad(a, d - a, b - a);
    let points: Vec<_> = rect.table("points").iter().map(|p| DVec3::from_slice(p)).zip(rect.list("T1")).collect();
    direct(&mut jury, "rectangle", light, rect.number("Le"), rect.number("rho"), &points);

    let disk = case("direct", "direct_disk_light");
    let center = DVec3::Z * disk.number("h");
    let light = Geometry::Disk { center, normal: DVec3::NEG_Z, radius: disk.number("R") };
    let points: Vec<_> = disk.list("offsets").iter().map(|x| DVec3::X * *x).zip(disk.list("T1")).collect();
    direct(&mut jury, "disk", light, disk.number("Le"), disk.number("rho"), &points);

    // a sphere wholly above the horizon is a point of intensity π R² Le
    let (ball, source) = (case("direct", "direct_sphere_equals_point"), case("direct", "direct_point_light"));
    let light = sphere(DVec3::Z * source.number("h"), ball.number("R"), false);
    let scale = ball.number("I") / source.number("I");
    let point = |(x, t): (&f64, f64)| (DVec3::Y * *x, t * scale);
    let offsets = source.list("offsets");
    let points: Vec<_> = offsets.iter().zip(source.list("T1")).map(point).collect();
    direct(&mut jury, "sphere", light, ball.number("Le"), source.number("rho"), &points);

    jury.assert_power(0.3, 0.15);
}
