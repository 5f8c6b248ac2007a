//! Which surfaces coincide, which of them is moved to the front, and of which a warning tells.

use super::*;

#[test]
fn built_in_scenes_stay_as_they_are() {
    for b in &builtin::ALL {
        let d = load::scene(b.name, &load::Options::default()).unwrap().description;
        let s = surfaces(&d);
        assert_eq!((moved(&s, &d), s.moved), (vec![], 0.0), "{}", b.name);
        assert_eq!(warned(&d), Vec::<[String; 2]>::new(), "{}", b.name);
    }
}

/// A lamp in the plane of each face of a room, as quad, mesh and disk, the whole turned by any angle: it comes to lie in front
/// by four times what rays may be off, or a little more, and nothing else moves.
#[test]
fn lamps_come_to_lie_in_front() {
    let mut noise = common::Noise(17);
    for lamp_shape in lamp_shapes() {
        for turn in 0..40 {
            let axis = any_axis(&mut noise);
            let turn = DQuat::from_axis_angle(axis, if turn == 0 { 0.0 } else { 6.3 * noise.uniform() });
            let mut parts: Vec<Part> = faces(&room()).into_iter().map(dark).collect();
            parts.push(lamp(lamp_shape.clone()));
            let d = mapped(&scene(parts), 1.0, |x| turn * x);
            let s = surfaces(&d);
            let lamps: Vec<usize> = (6..s.list.len()).collect();
            assert_eq!(moved(&s, &d), lamps, "{turn}");
            for o in &s.overlaps {
                assert!(o.pair[0] == 3 && o.pair[1] >= 6 && o.same_way, "{o:?}");
                // the height of the ceiling over the lamp
                assert!(-o.height[1] > 0.999 * o.gap && -o.height[0] < 1.01 * o.gap, "{o:?}");
                assert_eq!([o.nearer(true), o.nearer(false)], [Some(1), Some(0)]);
            }
            assert_eq!(s.overlaps.len(), lamps.len());
            // Σ |nᵢ| Rᵢ is 3 at most in a room of this size
            assert!(s.moved < 1.01 * 3.0 * 64.0 / 2f64.powi(24), "{}", s.moved);
        }
    }
}

#[test]
fn what_only_touches_or_lies_clearly_in_front_does_not_count() {
    let pairs = [
        // edges, a corner, a shared edge of two halves, parallel planes a millimetre apart
        vec![above([0.0, 0.0], [1.0, 1.0], 0.0), above([1.0, 0.0], [2.0, 1.0], 0.0)],
        vec![above([0.0, 0.0], [1.0, 1.0], 0.0), above([1.0, 1.0], [2.0, 2.0], 0.0)],
        vec![mesh(&above([0.0, 0.0], [1.0, 1.0], 0.0))],
        vec![above([0.0, 0.0], [1.0, 1.0], 0.0), above([0.2, 0.2], [0.8, 0.8], 1e-3)],
        vec![above([0.0, 0.0], [1.0, 1.0], 0.0), block([0.0, 0.001, 0.0], [1.0, 0.5, 1.0])],
        vec![room(), above([-1.0, -1.0], [1.0, 1.0], 0.0)],
    ];
    for geometries in pairs {
        let d = scene(geometries.into_iter().map(lamp).collect());
        let s = surfaces(&d);
        assert_eq!((s.overlaps.len(), moved(&s, &d)), (0, vec![]), "{:?}", d.shapes);
    }
}

#[test]
fn scaling_by_powers_of_two_changes_no_bit_and_shifts_no_pair() {
    let mut parts: Vec<Part> = faces(&room()).into_iter().map(dark).collect();
    parts.push(lamp(below([-0.3, -0.3], [0.3, 0.3], 1.0)));
    parts.push(dark(block([-0.5, -1.0, -0.5], [0.1, -0.2, 0.3])));
    parts.push(lamp(Geometry::Disk { center: DVec3::X, normal: DVec3::NEG_X, radius: 0.2 }));
    let plain = scene(parts);
    let turn = DQuat::from_axis_angle(DVec3::new(0.3, 0.9, 0.1).normalize(), 0.7);
    let quads = Description {
        shapes: plain.shapes.iter().filter(|s| !matches!(s.geometry, Geometry::Box { .. })).cloned().collect(),
        ..plain.clone()
    };
    for d in [plain, mapped(&quads, 1.0, |x| turn * x)] {
        let s = surfaces(&d);
        assert!(s.overlaps.len() >= 2);
        for k in [-30, 12] {
            let f = 2f64.powi(k);
            let t = surfaces(&mapped(&d, f, |x| f * x));
            let scaled = |o: &Overlap| Overlap { height: o.height.map(|h| f * h), gap: f * o.gap, ..*o };
            assert_eq!(t.overlaps, s.overlaps.iter().map(scaled).collect::<Vec<_>>());
            assert_eq!(t.moved, f * s.moved);
        }
        for far in [1e3, 1e6, 1e8] {
            let t = surfaces(&mapped(&d, 1.0, |x| x + DVec3::new(far, -0.7 * far, 0.3 * far)));
            let pairs = |s: &Surfaces| s.overlaps.iter().map(|o| (o.pair, o.same_way)).collect::<Vec<_>>();
            assert_eq!(pairs(&t), pairs(&s), "{far}");
            assert!((t.moved - s.moved).abs() < 0.02 * s.moved, "{far}: {} {}", t.moved, s.moved);
        }
    }
}

#[test]
fn of_emitters_that_look_the_same_way_the_first_lies_in_front() {
    let d = scene(vec![
        dark(room()),
        lamp(below([-0.3, -0.3], [0.3, 0.3], 1.0)),
        lamp(below([0.0, 0.0], [0.5, 0.5], 1.0)),
        lamp(above([-0.1, -0.1], [0.1, 0.1], 1.0)),
    ]);
    let s = surfaces(&d);
    assert_eq!(moved(&s, &d), [6, 7, 8]);
    for o in &s.overlaps {
        // seen from inside the room: the ceiling (3) looks down as 6 and 7 do, 8 looks up
        let from_below = o.nearer(true).map(|i| o.pair[i]);
        let from_above = o.nearer(false).map(|i| o.pair[i]);
        match o.pair {
            [3, 8] => assert_eq!([from_below, from_above], [Some(3), Some(8)]),
            [3, lamp] => assert_eq!([from_below, from_above], [Some(lamp), Some(3)]),
            [lamp, 8] => assert_eq!([from_below, from_above], [Some(lamp), Some(8)]),
            pair => assert_eq!((pair, from_below, from_above), ([6, 7], Some(6), Some(7))),
        }
    }
}

#[test]
fn balls_that_coincide_are_found_too() {
    let ball = |z, inward| Geometry::Sphere { center: DVec3::new(0.1, 0.2, 0.3), radius: 0.4, z, inward };
    let all = [-1.0, 1.0];
    let d = scene(vec![dark(room()), dark(ball(all, false)), lamp(ball(all, false)), dark(ball([0.5, 1.0], true))]);
    let s = surfaces(&d);
    assert_eq!(s.overlaps.iter().map(|o| o.pair).collect::<Vec<_>>(), [[6, 7], [6, 8], [7, 8]]);
    assert_eq!(moved(&s, &d), [7]);
    let Primitive::Sphere { radius, .. } = s.list[7].1 else { panic!() };
    assert!(radius > 0.4 && radius < 0.4 + 1e-5, "{radius}");
    // the lower band and the upper one only touch
    let d = scene(vec![dark(room()), dark(ball([-1.0, 0.5], false)), dark(ball([0.5, 1.0], false))]);
    assert_eq!(surfaces(&d).overlaps, []);
}

/// What is seen and has no right answer is named; what is hidden, alike or in front is not.
#[test]
fn warnings_come_where_paths_come() {
    let rug = above([-0.4, -0.4], [0.3, 0.2], -1.0);
    let painted = |g, rho, sides| Part(g, rho, 0.0, sides);
    let light = || lamp(below([-0.3, -0.3], [0.3, 0.3], 0.99));
    let case = |parts: Vec<Part>| scene([dark(room()), light()].into_iter().chain(parts).collect());
    let names = |a: usize, b: usize| vec![[a, b].map(|i| format!("shapes[{i}]"))];
    let front = Sides::Front;
    let ball = |z| Geometry::Sphere { center: DVec3::new(0.0, -0.5, -0.3), radius: 0.3, z, inward: false };
    let cases: Vec<(&str, Description, Vec<[String; 2]>)> = vec![
        ("a rug", case(vec![painted(rug.clone(), 0.3, front)]), names(0, 2)),
        ("a rug with two sides", case(vec![painted(rug.clone(), 0.3, Sides::Both)]), names(0, 2)),
        (
            "a rug the size of a coin",
            case(vec![painted(above([0.2, 0.2], [0.22, 0.22], -1.0), 0.3, front)]),
            names(0, 2),
        ),
        ("a rug like the floor", case(vec![painted(rug.clone(), GREY, front)]), vec![]),
        ("a rug upside down", case(vec![painted(below([-0.4, -0.4], [0.3, 0.2], -1.0), GREY, front)]), names(0, 2)),
        ("a standing block", case(vec![dark(block([-0.5, -1.0, -0.5], [0.1, -0.2, 0.3]))]), vec![]),
        (
            "one of two sides",
            case(vec![painted(block([-0.5, -1.0, -0.5], [0.1, -0.2, 0.3]), 0.3, Sides::Both)]),
            vec![],
        ),
        ("in a corner", case(vec![painted(block([-1.0, -1.0, -1.0], [-0.4, -0.2, 0.3]), 0.3, Sides::Both)]), vec![]),
        (
            "two in a stack",
            case(vec![
                dark(block([-0.5, -1.0, -0.5], [0.1, -0.6, 0.3])),
                painted(block([-0.5, -0.6, -0.5], [0.1, -0.2, 0.3]), 0.2, front),
            ]),
            vec![],
        ),
        (
            "two quads in the air",
            case(vec![
                painted(above([-0.4, -0.4], [0.3, 0.2], -0.5), 0.3, front),
                painted(above([0.1, 0.0], [0.5, 0.5], -0.5), 0.5, front),
            ]),
            names(2, 3),
        ),
        (
            "a block twice",
            case(vec![
                dark(block([-0.5, -0.9, -0.5], [0.1, -0.2, 0.3])),
                dark(block([-0.5, -0.9, -0.5], [0.1, -0.2, 0.3])),
            ]),
            vec![],
        ),
        (
            "in two colours",
            case(vec![
                dark(block([-0.5, -0.9, -0.5], [0.1, -0.2, 0.3])),
                painted(block([-0.5, -0.9, -0.5], [0.1, -0.2, 0.3]), 0.3, front),
            ]),
            names(2, 3),
        ),
        ("two balls", case(vec![dark(ball([-1.0, 1.0])), painted(ball([-1.0, 1.0]), 0.3, front)]), names(2, 3)),
        ("two equal balls", case(vec![dark(ball([-1.0, 1.0])), dark(ball([-1.0, 1.0]))]), vec![]),
        ("two lamps", case(vec![lamp(below([0.0, 0.0], [0.5, 0.5], 0.99))]), vec![]),
        ("two lamps that differ", case(vec![Part(below([0.0, 0.0], [0.5, 0.5], 0.99), GREY, 5.0, front)]), names(1, 2)),
        ("a lamp in the ceiling", case(vec![lamp(below([0.5, 0.5], [0.9, 0.9], 1.0))]), vec![]),
        ("a lamp that stands", case(vec![lamp(block([0.3, -1.0, 0.3], [0.5, -0.9, 0.5]))]), vec![]),
    ];
    for (what, d, expected) in cases {
        assert_eq!(warned(&d), expected, "{what}");
    }
}

/// Glass is counted by its surfaces: twice is not once.
#[test]
fn glass_twice_is_a_conflict() {
    let d = load::scene("caustic", &load::Options::default()).unwrap().description;
    assert_eq!(warned(&d), Vec::<[String; 2]>::new());
    let mut twice = d.clone();
    twice.shapes.push(d.shapes[1].clone());
    assert_eq!(warned(&twice).len(), 1);
}

#[test]
fn relations_say_which_kind() {
    let d = scene(vec![
        dark(room()),
        lamp(below([-0.3, -0.3], [0.3, 0.3], 1.0)),
        dark(block([-0.5, -1.0, -0.5], [0.1, -0.2, 0.3])),
        dark(above([0.3, 0.3], [0.6, 0.6], -1.0)),
    ]);
    let kinds: Vec<_> = surfaces(&d).relations(&d).iter().map(|r| (r.shapes, r.kind)).collect();
    assert_eq!(kinds, [([0, 1], Kind::InFront), ([0, 2], Kind::Differ), ([0, 3], Kind::Alike)]);
}

/// A mesh of 10⁵ triangles twice: each overlaps its twin and nothing else.
#[test]
fn meshes_of_many_triangles_are_searched_by_a_tree() {
    let n = 224u32;
    let at = |i: u32, j: u32| {
        let (x, z) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
        DVec3::new(x, if i < n / 2 { 0.0 } else { 0.1 * (7.0 * x).sin() * (5.0 * z).cos() }, z)
    };
    let vertices: Vec<DVec3> = (0..=n).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let cell = |i: u32, j: u32| {
        let a = j * (n + 1) + i;
        [[a, a + n + 1, a + 1], [a + 1, a + n + 1, a + n + 2]]
    };
    let faces: Vec<[u32; 3]> = (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect();
    let m = Geometry::Mesh { vertices, faces, uvs: vec![] };
    let d = scene(vec![dark(m.clone()), dark(m)]);
    let started = std::time::Instant::now();
    let s = surfaces(&d);
    let took = started.elapsed();
    eprintln!("{} triangles in {took:?}", s.list.len());
    let half = s.list.len() / 2;
    assert!(half > 100_000);
    assert_eq!(s.overlaps.len(), half);
    assert!(s.overlaps.iter().all(|o| o.pair[1] == o.pair[0] + half));
    assert_eq!(s.moved, 0.0);
}
