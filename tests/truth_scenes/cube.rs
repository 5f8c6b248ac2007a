//! The continuous cube, known to seven digits by spectral collocation.

use super::*;

/// Fixed points and whole faces of the unit cube.
fn cube_pixels(scene: &Scene, cases: &[Case; 3], faces: &[u32]) -> Vec<Pixel> {
    let mut pixels = vec![];
    for (i, at) in cases[0].table("points").iter().enumerate() {
        let (axis, far) = (at[0] as usize / 2, at[0] as usize % 2);
        let mut p = DVec3::ZERO;
        p[axis] = far as f64;
        p[if axis == 0 { 1 } else { 0 }] = at[1];
        p[if axis == 2 { 1 } else { 2 }] = at[2];
        let mut n = DVec3::ZERO;
        n[axis] = if far == 1 { -1.0 } else { 1.0 };
        pixels.push(Pixel {
            what: format!("point {at:?}"),
            start: Start::At(point(scene, p, n)),
            terms: (0..=K).map(|k| three(cases, |c| c.table("terms_pts")[k][i])).collect(),
            total: three(cases, |c| c.list("L_pts")[i]),
        });
    }
    for (i, &side) in faces.iter().enumerate() {
        pixels.push(Pixel {
            what: format!("face {i}"),
            start: Start::On(side),
            terms: (0..=K).map(|k| three(cases, |c| c.table("face_integrals_terms")[k][i])).collect(),
            total: three(cases, |c| c.list("face_integrals_L")[i]),
        });
    }
    pixels
}

/// Whole faces glow. A connection to a face that touches one's own has infinite variance near the edge, so `connect` is
/// left to the patch light below.
#[test]
fn glowing_faces_of_a_cube_have_their_terms() {
    let mut jury = Jury::open("glowing_faces_of_a_cube_have_their_terms");
    for ids in [
        ["cube_cont_u50", "cube_cont_u80", "cube_cont_cornell"],
        ["cube_cont_blackceil", "cube_cont_mixed", "cube_cont_mixed"],
    ] {
        let cases = ids.map(|id| case("cube", id));
        let face =
            |(i, g): (usize, Geometry)| (g, three(&cases, |c| c.list("rho")[i]), three(&cases, |c| c.list("E")[i]));
        let surfaces: Vec<Surface> = cube_faces().into_iter().enumerate().map(face).collect();
        let scene = Scene::new(&description(&surfaces));
        let pixels = cube_pixels(&scene, &cases, &[0, 2, 4, 6, 8, 10]);
        check(&mut jury, &scene, &pixels, Kind::Prefix, Technique::Scatter, 1 << 16);
        check(&mut jury, &scene, &pixels, Kind::Prefix, Technique::Mis, 1 << 16);
        check(&mut jury, &scene, &pixels, Kind::Path, Technique::Mis, 1 << 14);
        check(&mut jury, &scene, &pixels, Kind::Single, Technique::Scatter, 1 << 13);
    }
    jury.assert_power(0.09, 0.14);
}

/// A square light in the middle of the ceiling.
#[test]
fn a_cube_with_a_patch_light_has_its_terms() {
    let mut jury = Jury::open("a_cube_with_a_patch_light_has_its_terms");
    let cases = ["cube_cont_patch"; 3].map(|id| case("cube", id));
    let rho = cases[0].list("rho");
    let mut surfaces: Vec<Surface> =
        cube_faces().into_iter().zip(&rho).map(|(g, r)| (g, DVec3::splat(*r), DVec3::ZERO)).collect();
    // the ceiling in nine tiles, the middle one glowing; y × x points down
    surfaces.truncate(5);
    let cuts = [0.0, 0.35, 0.65, 1.0];
    for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
        let (dx, dy) = (cuts[i + 1] - cuts[i], cuts[j + 1] - cuts[j]);
        let tile = quad(DVec3::new(cuts[i], cuts[j], 1.0), DVec3::Y * dy, DVec3::X * dx);
        let glow = if (i, j) == (1, 1) { 5.0 } else { 0.0 };
        surfaces.push((tile, DVec3::splat(rho[5]), DVec3::splat(glow)));
    }
    let scene = Scene::new(&description(&surfaces));
    let pixels = cube_pixels(&scene, &cases, &[0, 2, 4, 6, 8]);
    for technique in TECHNIQUES {
        check(&mut jury, &scene, &pixels, Kind::Prefix, technique, 1 << 16);
    }
    check(&mut jury, &scene, &pixels, Kind::Single, Technique::Mis, 1 << 14);
    check(&mut jury, &scene, &pixels, Kind::Path, Technique::Connect, 1 << 14);
    jury.assert_power(0.13, 0.17);
}
