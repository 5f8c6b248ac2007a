//! `fredholm compare`: equal and different results, other kinds, other sizes, and what one side does not see.

use super::*;

#[test]
fn two_seeds_agree_and_another_albedo_differs() {
    let desk = Desk::new();
    let series = "series furnace --worlds terms,path --spp 1024";
    desk.small("a", &format!("{series} --seed 1"));
    desk.small("b", &format!("{series} --seed 2"));
    desk.small("c", &format!("{series} --seed 2 --set materials.wall.reflectance=[0.55,0.5,0.5]"));
    let said = desk.run("compare a b --of-term 0.1");
    assert_eq!(said.code, 0, "{}", said.out);
    assert!(
        said.out.starts_with("The two results agree: every difference is proved smaller than 10 %"),
        "{}",
        said.out
    );
    let said = desk.run("compare a/summary.json c -o verdict");
    assert_eq!(said.code, 1, "{}", said.out);
    assert!(said.out.starts_with("The two results differ in T1, "), "{}", said.out);
    assert!(row(&said.out, "T1 (").concat().ends_with("✗ differs"), "{}", said.out);
    assert!(row(&said.out, "T0 (").concat().ends_with("✓ agrees"), "{}", said.out);
    assert_eq!(names(&desk.path("verdict")), ["summary.json", "z.png"]);
    // a comparison is no result
    let said = desk.run("compare a verdict");
    assert_eq!(said.code, 3);
    assert!(said.err.contains("holds no world"), "{}", said.err);
}

#[test]
fn results_of_different_kinds_are_compared_in_what_they_share() {
    let desk = Desk::new();
    desk.small("terms", "series cornell --worlds terms --spp 32");
    desk.ok("render cornell --spp 32 --seed 1 --size 16x16 --max-bounces 3 -q -o path");
    desk.small("matrix", "radiosity cornell --spp 32");
    let lines = |said: &Said| said.out.lines().filter(|l| l.contains(" (")).count();
    let said = desk.run("compare path terms");
    assert!(said.out.contains("path tracer, mis, roulette lecture"), "{}", said.out);
    assert_eq!(row(&said.out, "total (").len(), 1, "{}", said.out);
    assert!(row(&said.out, "T0 (").is_empty() && lines(&said) > 0, "the path tracer has no terms\n{}", said.out);

    // the interval against a matrix is widened by |R_h − R_2h|
    let said = desk.run("compare terms matrix --json -o x");
    let json: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let rows = json["rows"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|r| r["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["T0", "T1", "T2", "T3", "tail", "sum", "total"]);
    let s = desk.summary("matrix");
    let (fine, coarse) = (s.series[0].image(), s.series[1].image());
    let allowance = |k: usize| (fine.terms[k].mean - coarse.terms[k].mean).abs().min_element();
    for k in [2, 3] {
        let of = |i: usize| rows[k]["interval"][i].as_f64().unwrap();
        assert!(allowance(k) > 0.0, "the mesh matters from k = 2 on");
        assert!(of(1) - of(0) > 2.0 * allowance(k), "k = {k}");
    }
}

#[test]
fn sizes_must_match() {
    let desk = Desk::new();
    desk.ok("render cornell --spp 4 --size 8x8 -q -o a");
    desk.ok("render cornell --spp 4 --size 8x9 -q -o b");
    let said = desk.run("compare a b");
    assert_eq!(said.code, 3);
    insta::assert_snapshot!(said.err, @r"
    error: the images have different sizes, 8×8 and 8×9
    help: render both with the same --size
    ");
    // pictures of another run beside the summary
    std::fs::copy(desk.path("b/terms.exr"), desk.path("a/terms.exr")).unwrap();
    let said = desk.run("compare b a");
    assert_eq!(said.code, 3);
    assert!(said.err.contains("sizes, 8×9 and 8×8"), "{}", said.err);
    let said = desk.run("compare a a");
    assert_eq!(said.code, 3);
    insta::assert_snapshot!(said.err, @r"
    error: the images have 8×9 pixels, and summary.json says 8×8 pixels
      --> a/terms.exr
    help: repeat the run: its files do not belong together
    ");
    assert!(!desk.path("fredholm-out").exists(), "nothing was written");
}

/// What one side cannot see is named and not compared; what both see is.
#[test]
fn terms_that_one_side_does_not_see_are_not_compared() {
    let desk = Desk::new();
    desk.small("p", "series cornell-spheres --worlds terms");
    let said = desk.small("l", "series cornell-spheres --worlds terms --estimator light");
    let missing = "not supported by light, from k = 1 on: what the eye sees in mirrors or glass";
    assert!(said.err.contains(missing), "{}", said.err);
    let said = desk.run("compare p l -o c");
    assert_eq!(said.code, 1, "{}", said.out);
    assert!(said.out.contains("T1 and everything longer is not compared: light cannot find"), "{}", said.out);
    let rows = desk.summary("c").verdicts;
    assert!(rows.iter().all(|v| v.name.contains("T0")) && rows.len() == 1, "{rows:?}");
    // a light that no ray hits is refused where rays must hit it
    let lamp = "[[lights]]\ntype = \"point\"\nposition = [0, 0.5, 0]\nintensity = [1, 1, 1]\n";
    let furnace = fredholm::scene::builtin::find("furnace").unwrap().source;
    let dark: Vec<&str> = furnace.lines().filter(|l| !l.starts_with("emission")).collect();
    std::fs::write(desk.path("point.toml"), format!("{}\n{lamp}", dark.join("\n"))).unwrap();
    let said = desk.run("series point.toml --technique scatter");
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(said.err.contains("help: use --technique connect or mis"), "{}", said.err);
    assert_eq!(desk.run("render cornell --estimator light").code, 2);
}
