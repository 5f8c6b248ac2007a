//! What makes no sense is refused in words, and outputs of other runs are safe.

use super::*;

#[test]
fn what_makes_no_sense_is_refused() {
    let desk = TempDir::new().unwrap();
    for (line, says) in [
        ("", "--over"),
        ("--over colour", "colour"),
        ("--over branching --values 0", "`0` is not a whole number from 1 to 1000"),
        ("--over branching --values 2,x", "`x` is not a whole number"),
        ("--over branching --values 2,", "`` is not a whole number"),
        ("--over technique --values guess", "`guess` is none of scatter, connect, mis"),
        ("--over sampling --values mis", "`mis` is none of uniform"),
        ("--over points --values halton", "`halton` is none of"),
        ("--over estimator --values dark", "`dark` is none of"),
        ("--over roulette --values half", "unknown roulette"),
        ("--over spp --values 0", "`0` is not a whole number"),
        ("--over spp --equal-rays", "--equal-rays"),
        ("--over spp --equal-time", "which --over spp sweeps over"),
        ("--over sampling --equal-time --equal-rays", "--equal-rays and --equal-time exclude each other"),
        ("--over patches --equal-time", "are for values with samples of their own"),
        ("--over spp --values 20", "20 samples are not the same number for each of the 16 replicates"),
        ("--over spp --values 16,64 --spp 32", "64 samples are more than --spp renders"),
        ("--over spp --estimator prefix,dark", "`dark` is none of prefix, single"),
        ("--over spp --estimator prefix,prefix", "`prefix` stands twice"),
        ("--over spp --roulette lecture,half", "unknown roulette"),
        ("--over spp --points halton", "`halton` is none of"),
        ("--over spp --reference 8", "a reference of 8 samples has no error of its own"),
        ("--over technique --estimator prefix,single", "--estimator takes one value here"),
        ("--over technique --estimator path", "`path` has one value for all terms"),
        ("--over technique --reference 64", "--reference is for --over spp"),
        ("--over split --estimator single", "--over split always compares single with prefix"),
        ("--over split --values equal", "--over split has no values"),
        ("--over split --equal-rays", "about the same rays already"),
        ("--over split --equal-time", "about the same rays already"),
        ("--over split --technique mis,connect", "--technique takes one value here"),
        ("--over spp --pilot 64", "--pilot is for --over split"),
        ("--over spp --patches 100", "unexpected argument '--patches'"),
        ("--over branching --values 1000", "1000 children at every vertex make 2.1e18 rays at depth 4"),
    ] {
        let said = run(desk.path(), &format!("sweep cornell {line}"));
        assert_eq!(said.code, 2, "{line}: {}", said.err);
        assert!(said.err.contains(says), "{line}: {}", said.err);
        assert!(said.out.is_empty());
        assert!(said.err.contains("error: "), "{}", said.err);
    }
    let said = run(desk.path(), "series cornell --estimator branching --branching 100 --size 64x64");
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(said.err.contains("help: choose fewer children"), "{}", said.err);
    assert!(!desk.path().join("fredholm-out").exists(), "nothing was written");
}

/// The rules of every other command: its own output is replaced, another run's never is.
#[test]
fn outputs_are_safe() {
    let desk = TempDir::new().unwrap();
    let sweep = |more: &str| run(desk.path(), &format!("sweep furnace --over points {SMALL} {more}")).code;
    assert_eq!((sweep("-o a"), sweep("-o a")), (0, 0));
    assert_eq!((sweep("-o a --seed 1"), sweep("-o a --seed 1 --force")), (3, 0));
    assert_eq!((sweep(""), sweep("--seed 1")), (0, 0));
    for name in ["furnace-sweep-points", "furnace-sweep-points-2"] {
        assert!(desk.path().join("fredholm-out").join(name).join("sweep.csv").exists(), "{name}");
    }
    let said = run(desk.path(), &format!("sweep furnace --over points {SMALL} -o a --force --json"));
    let json: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(json["series"].as_array().unwrap().len(), 2);
}
