//! `summary.json`: what is written is read back, and what others wrote is refused.

use super::*;

/// Equality through the text: NaN differs from itself, its name does not.
#[test]
fn summary_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("summary.json");
    let wanted = full_summary();
    summary::write(&path, &wanted).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let found = summary::read(&path).unwrap();
    assert!(found.verdicts[0].interval.0.is_nan(), "infinity is null, and null is NaN");
    let mut expected = wanted.clone();
    expected.verdicts[0].interval.0 = f64::NAN;
    assert_eq!(format!("{found:?}"), format!("{expected:?}"));
    assert!(found.tail.std_error.is_nan() && found.terms[0].ratio.is_nan() && found.path.is_none());
    assert_eq!(found.series[0].cost, wanted.series[0].cost);

    // The keys of the design, in the file.
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    for key in [
        "schema",
        "version",
        "command",
        "scene",
        "scene_hash",
        "seed",
        "spp",
        "max_bounces",
        "threads",
        "seconds",
        "terms",
        "tail",
        "sum",
        "path",
        "radiosity",
        "bounds",
        "cross_moments",
        "verdicts",
        "files",
        "width",
        "height",
        "series",
    ] {
        assert!(value.get(key).is_some(), "no key {key}");
    }
    for key in ["k", "mean", "std_error", "variance", "ratio", "rays"] {
        assert!(value["terms"][0].get(key).is_some(), "no key terms[0].{key}");
    }
    assert!(value["tail"]["std_error"][0].is_null() && value["cross_moments"].is_null());
}

#[test]
fn summaries_of_others_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("summary.json");
    let good = serde_json::to_string(&full_summary()).unwrap();
    for (text, words) in [
        (good.replace("fredholm-summary", "other"), "the schema is `other`"),
        (good.replace("\"version\":1", "\"version\":2"), "version 2"),
        (good.replace("\"spp\"", "\"ssp\""), "missing field `spp`"),
        (good.replace("inconclusive", "perhaps"), "perhaps"),
        (good.replace("\"functionals\":[{", "\"functionals\":[],\"others\":[{"), "the image mean is missing"),
        ("{}".into(), "no key `schema`"),
        ("[1,".into(), "not valid JSON"),
        // A null is NaN only where a floating-point number belongs.
        (good.replace("\"threads\":0", "\"threads\":null"), "null"),
    ] {
        std::fs::write(&path, text).unwrap();
        let message = summary::read(&path).unwrap_err().to_string();
        assert!(message.contains(words) && message.contains("help: "), "{words}: {message}");
    }
}

proptest! {
    /// Every number survives the file bit by bit.
    #[test]
    fn numbers_survive(bits in prop::array::uniform3(any::<u64>())) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.json");
        let numbers = bits.map(f64::from_bits);
        let mean = DVec3::from_array(numbers);
        summary::write(&path, &Summary { sum: Estimate::exact(mean), ..Summary::default() }).unwrap();
        for (found, wanted) in summary::read(&path).unwrap().sum.mean.to_array().into_iter().zip(numbers) {
            if wanted.is_finite() {
                prop_assert_eq!(found.to_bits(), wanted.to_bits());
            } else {
                prop_assert!(found.is_nan());
            }
        }
    }
}
