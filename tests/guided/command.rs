//! The guide on the command line: renders by the clock, and what it cannot do.

/// A folder of its own, and what the program says there.
fn fredholm(desk: &tempfile::TempDir, line: &str) -> (i32, String) {
    let said = super::common::program::run(desk.path(), line);
    (said.code, said.out + &said.err)
}

/// `--time` decides how many samples there are and nothing else; so does a guide know only the seed.
#[test]
fn a_render_by_the_clock_is_one_of_so_many_samples() {
    let desk = tempfile::TempDir::new().unwrap();
    let read = |dir: &str| fredholm::report::text::summary::read(&desk.path().join(dir).join("summary.json")).unwrap();
    for guide in ["bsdf", "radiosity --patches 200"] {
        let line = format!("series cornell --worlds terms --size 8x8 --max-bounces 2 -q -v --force --guide {guide}");
        let (code, text) = fredholm(&desk, &format!("{line} --time 1500ms -o clock"));
        assert_eq!(code, 0, "{text}");
        let clock = read("clock");
        assert!(clock.spp >= 16 && clock.spp.is_multiple_of(16), "{} spp", clock.spp);
        assert_eq!(text.contains("guide: radiosity"), guide != "bsdf", "{text}");
        let (code, text) = fredholm(&desk, &format!("{line} --spp {} -o count", clock.spp));
        assert_eq!(code, 0, "{text}");
        let count = read("count");
        assert_eq!(clock.spp, count.spp);
        assert_eq!(clock.series[0].functionals, count.series[0].functionals, "{guide}");
    }
}

#[test]
fn what_a_guide_cannot_do_is_refused() {
    let desk = tempfile::TempDir::new().unwrap();
    for (line, why) in [
        ("series cornell --guide radiosity --estimator light", "walks from the eye only"),
        ("series cornell --guide radiosity --sampling uniform", "replaces the cosine"),
        ("radiosity cornell --guide radiosity", "unexpected argument '--guide'"),
        ("sweep cornell --over spp --guide radiosity", "unexpected argument '--guide'"),
        ("sweep cornell --over spp --time 1s", "unexpected argument '--time'"),
        ("series cornell --time 1s --spp 4", "cannot be used with"),
        ("series cornell --time soon", "is not a time such as 30s"),
    ] {
        let (code, text) = fredholm(&desk, line);
        assert!(code == 2 && text.contains(why), "{line}: {code}, {text}");
    }
}
