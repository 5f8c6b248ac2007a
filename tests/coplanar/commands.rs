//! What the commands say of surfaces that coincide.

use super::*;

/// The command line: a count and names in `info`, a warning, and no verdict with the exit code of one.
#[test]
fn commands_name_what_coincides() {
    let desk = tempfile::tempdir().unwrap();
    let file = |rug: &str| {
        format!(
            "name = \"rug\"\n[camera]\norigin = [0, 0, 0.95]\ntarget = [0, -0.3, 0]\nup = [0, 1, 0]\nfov = 90\nsize = [8, 8]\n\
             [materials.w]\ntype = \"diffuse\"\nreflectance = [0.6, 0.6, 0.6]\nsides = \"front\"\n\
             [materials.r]\ntype = \"diffuse\"\nreflectance = [0.1, 0.2, 0.3]\nsides = \"both\"\n\
             [[shapes]]\ntype = \"box\"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\ninward = true\nmaterial = \"w\"\n\
             [[shapes]]\ntype = \"quad\"\norigin = [-0.3, 1, -0.3]\nedge_u = [0.6, 0, 0]\nedge_v = [0, 0, 0.6]\n\
             material = \"w\"\nemission = [10, 10, 10]\n\
             [[shapes]]\ntype = \"quad\"\norigin = [-0.5, {rug}, -0.5]\nedge_u = [0, 0, 1]\nedge_v = [1, 0, 0]\nmaterial = \"r\"\n"
        )
    };
    std::fs::write(desk.path().join("flush.toml"), file("-1")).unwrap();
    std::fs::write(desk.path().join("raised.toml"), file("-0.999")).unwrap();
    let run = |line: &str| {
        let said = super::common::program::run(desk.path(), line);
        (said.code, said.out, said.err)
    };
    let words = "shapes `shapes[0]` and `shapes[2]` overlap in one plane and look different";
    let (code, out, err) = run("info flush.toml");
    assert_eq!(code, 0);
    assert!(out.contains("coplanar overlaps: 2"), "{out}");
    assert!(out.contains("shapes[0] and shapes[1]: what emits lies in front"), "{out}");
    assert!(out.contains("shapes[0] and shapes[2]: they differ"), "{out}");
    assert!(err.contains(words), "{err}");
    let (code, out, err) = run("series flush.toml --spp 32 --patches 60 -q -o a");
    let unwrapped = out.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = unwrapped.contains(&format!("no verdict, because {words}"));
    assert!(code == 0 && err.contains(words) && said, "{code} {out} {err}");
    assert!(out.lines().all(|l| l.chars().count() <= 100), "{out}");
    let summary = fredholm::report::text::summary::read(&desk.path().join("a/summary.json")).unwrap();
    assert!(summary.verdicts.iter().all(|v| v.outcome == fredholm::stats::Outcome::Inconclusive));
    assert!(summary.series.iter().all(|s| s.undecided.as_deref() == Some(words)));
    let (code, out, _) = run("check bias --scene flush.toml --spp 4096 --batch 64 -q -o b");
    assert!(code == 0 && out.contains("No verdict"), "{code} {out}");
    let (code, out, _) = run("check equilibrium flush.toml --spp 64 --points 8 -q -o c");
    assert!(code == 0 && out.contains("No verdict"), "{code} {out}");
    let (code, out, _) = run("compare a a -o d");
    assert!(code == 1 && out.contains("No verdict"), "{code} {out}");
    // a millimetre above the floor all is well
    let (_, out, err) = run("info raised.toml");
    assert!(out.contains("coplanar overlaps: 1") && !err.contains("warning"), "{out} {err}");
    let (_, out, _) = run("series raised.toml --spp 32 --patches 60 -q -o e");
    assert!(!out.to_lowercase().contains("no verdict"), "{out}");
}

/// No verdict where the scene has no right answer, whatever the numbers.
#[test]
fn comparisons_of_a_scene_without_a_right_answer_are_undecided() {
    let rug = Part(above([-0.4, -0.4], [0.3, 0.2], -1.0), 0.1, 0.0, Sides::Front);
    let d = scene(vec![dark(room()), lamp(below([-0.3, -0.3], [0.3, 0.3], 0.9)), rug]);
    let scene = Scene::new(&d);
    let run =
        |seed| by_rays::terms(&scene, Estimator::Prefix, &settings(Technique::Mis, 64, seed), Progress::NONE).series;
    let (a, mut b) = (run(1), run(2));
    assert!(a.undecided.as_deref().unwrap().contains("`shapes[0]` and `shapes[2]`"), "{:?}", a.undecided);
    // far off, and certainly so
    b.functionals.iter_mut().for_each(|f| f.total.mean *= 3.0);
    let c = compare(&a, &b, &Criterion::default(), &[]);
    assert_eq!((c.outcome, c.undecided.clone()), (Outcome::Inconclusive, a.undecided.clone()));
    assert!(c.rows.iter().all(|r| r.outcome == Outcome::Inconclusive && r.reason.is_some()));
    let plain = |s: &Series| Series { undecided: None, ..s.clone() };
    assert_eq!(compare(&plain(&a), &plain(&b), &Criterion::default(), &[]).outcome, Outcome::Differs);
    // one side is enough
    assert_eq!(compare(&plain(&a), &b, &Criterion::default(), &[]).outcome, Outcome::Inconclusive);
}
