//! Suggestions for mistyped values: the nearest known name, or this program's word for another renderer's term.
//!
//! | input | suggestion |
//! |---|---|
//! | a typing error, `conect` | the nearest name, [`similar`] |
//! | another renderer's word, `nee` | the word used here, from [`FOREIGN`] |

use super::base::{Failure, usage};
use fredholm::math::names::{either, list, similar};

/// Words of other renderers and textbooks: option, their words, this program's value, and what that value is.
const FOREIGN: &[(&str, &[&str], &str, &str)] = &[
    (
        "--technique",
        &["nee", "next-event", "next-event-estimation", "direct", "light", "lights", "emitter", "explicit", "shadow"],
        "connect",
        "next-event estimation is called `connect` here",
    ),
    (
        "--technique",
        &["bsdf", "brdf", "unidirectional", "implicit", "naive", "simple", "pt", "path", "hit"],
        "scatter",
        "finding light by BSDF sampling alone is called `scatter` here",
    ),
    (
        "--technique",
        &["balance", "both", "combined", "combine", "all", "mis-balance", "multiple"],
        "mis",
        "the balance heuristic over both techniques is called `mis` here",
    ),
    ("--technique", &["power", "power2", "mis2"], "mis-power", "the power heuristic is called `mis-power` here"),
    (
        "--estimator",
        &["bdpt", "bpt", "bidir", "veach"],
        "bidirectional",
        "bidirectional path tracing is called `bidirectional` here",
    ),
    (
        "--estimator",
        &["lt", "light-tracing", "lighttracer", "particle", "particles", "ptracer", "adjoint", "photon"],
        "light",
        "tracing particles from the lights is called `light` here",
    ),
    (
        "--estimator",
        &["distributed", "distribution", "tree", "splitting", "split", "whitted", "cook"],
        "branching",
        "a tree of rays is called `branching` here",
    ),
    ("--estimator", &["separate", "independent", "one", "term"], "single", "one path per term is called `single` here"),
    (
        "--estimator",
        &["path", "pt", "path-tracer", "pathtracer", "unidirectional", "reuse"],
        "prefix",
        "path tracing that keeps every term is called `prefix` here; the plain path tracer is `fredholm render`",
    ),
    ("--sampling", &["hemisphere", "solid-angle", "sphere"], "uniform", "uniform directions are called `uniform` here"),
    (
        "--sampling",
        &["cos", "lambert", "lambertian", "diffuse"],
        "cosine",
        "directions in proportion to the cosine are called `cosine` here",
    ),
    (
        "--sampling",
        &["brdf", "importance", "material", "ggx"],
        "bsdf",
        "importance sampling of the BSDF is called `bsdf` here",
    ),
    (
        "--points",
        &["qmc", "owen", "low-discrepancy", "halton", "hammersley", "zsobol", "paddedsobol", "ldsampler", "stratified"],
        "sobol",
        "the low-discrepancy points here are `sobol`",
    ),
    (
        "--points",
        &["random", "mc", "iid", "uniform", "pseudo-random"],
        "independent",
        "independent random numbers are called `independent` here",
    ),
    (
        "--lights",
        &["bvh", "spatial", "importance", "flux", "emission", "lighttree", "light-tree"],
        "power",
        "selecting a light in proportion to its power is called `power` here",
    ),
    (
        "--lights",
        &["random", "equal", "all", "one"],
        "uniform",
        "every light with the same probability is called `uniform` here",
    ),
    (
        "--roulette",
        &["rr", "russian", "russian-roulette", "yes", "on", "default", "true"],
        "lecture",
        "Russian roulette as in the lecture (q = 0.5 after two vertices) is called `lecture`",
    ),
    ("--roulette", &["off", "no", "never", "false", "0"], "none", "paths without roulette are called `none` here"),
    (
        "--roulette",
        &["reflectance", "brdf", "survival", "luminance"],
        "albedo",
        "survival with probability albedo is called `albedo` here",
    ),
    (
        "--roulette",
        &["beta", "weight", "pbrt"],
        "throughput",
        "roulette by the path's weight is called `throughput` here",
    ),
    ("--guide", &["none", "off", "no", "brdf"], "bsdf", "scattering without a guide is called `bsdf` here"),
    ("--guide", &["matrix", "guided", "guiding", "on"], "radiosity", "the guide here is a radiosity solution"),
    ("--worlds", &["pt", "path-tracer", "pathtracer", "render"], "path", "the full path tracer is called `path` here"),
    ("--worlds", &["matrix", "fem", "patches"], "radiosity", "the matrix is called `radiosity` here"),
    (
        "--worlds",
        &["series", "neumann", "bounces"],
        "terms",
        "the Neumann series, term by term, is called `terms` here",
    ),
    ("--factors", &["matrix", "exact", "full"], "dense", "a full matrix of form factors is called `dense` here"),
    (
        "--factors",
        &["mc", "monte-carlo", "sampled", "sparse"],
        "rays",
        "form factors by stored rays are called `rays` here",
    ),
    ("--solver", &["gs", "gauss", "seidel", "gathering"], "gauss-seidel", "Gauss–Seidel is called `gauss-seidel` here"),
    ("--solver", &["direct", "exact"], "lu", "the direct solution is called `lu` here"),
    ("--solver", &["shooting", "progressive"], "southwell", "progressive shooting is called `southwell` here"),
    ("--solver", &["krylov", "conjugate-gradients"], "cg", "conjugate gradients are called `cg` here"),
    ("--solver", &["series", "richardson"], "neumann", "the partial sums of the series are called `neumann` here"),
];

/// The question for a mistyped value of an option; nothing if no known value comes near.
pub fn question(option: &str, word: &str, known: &[&str]) -> Option<String> {
    let lower = word.to_lowercase().replace([' ', '_'], "-");
    let foreign = FOREIGN.iter().find(|f| f.0 == option && f.1.contains(&lower.as_str()));
    // another renderer's word may mean a value that this command does not take
    if let Some((_, _, here, why)) = foreign.filter(|f| known.is_empty() || known.contains(&f.2)) {
        return Some(format!("did you mean `{here}`? {why}"));
    }
    if option == "--roulette" && lower.parse::<f64>().is_ok_and(|q| q > 0.0 && q < 1.0) {
        return Some(format!("did you mean `constant:{lower}`? q = {lower} is the probability of termination"));
    }
    match similar(word, known.iter().copied()).as_slice() {
        [] => None,
        near => Some(format!("did you mean {}?", either(near))),
    }
}

/// A help line for a mistyped value of an option: the question, and all values if there are any.
pub fn hint(option: &str, word: &str, known: &[&str]) -> String {
    let all = (!known.is_empty()).then(|| format!("values of {option}: {}", list(known)));
    let question = question(option, word, known);
    let blocks: Vec<String> = question.into_iter().chain(all).collect();
    if blocks.is_empty() {
        format!("`fredholm series --help` describes the values of {option}")
    } else {
        blocks.join("\n      ")
    }
}

/// The error for a value that is wrong for a reason known already, with a suggestion.
pub fn wrong_value(option: &str, word: &str, why: &str, known: &[&str]) -> Failure {
    usage(&format!("{option}: {why}"), &hint(option, word, known))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_other_renderers_lead_to_values_that_the_option_has() {
        let techniques = ["scatter", "connect", "mis", "mis-power"];
        let asked = |word| question("--technique", word, &techniques).unwrap_or_default();
        assert!(asked("nee").starts_with("did you mean `connect`? next-event estimation"));
        assert!(asked("NEE").starts_with("did you mean `connect`?"));
        assert_eq!(asked("conect"), "did you mean `connect`?");
        assert_eq!(asked("teapot"), "");
        assert!(asked("bsdf").starts_with("did you mean `scatter`?"));
        assert!(question("--roulette", "0.3", &[]).is_some_and(|q| q.contains("constant:0.3")));
        // a walk takes no `light`, say
        assert_eq!(question("--estimator", "lt", &["prefix", "single"]), None);
    }

    #[test]
    fn no_word_stands_for_two_values() {
        for (i, a) in FOREIGN.iter().enumerate() {
            for b in FOREIGN[i + 1..].iter().filter(|b| a.0 == b.0) {
                assert!(a.1.iter().all(|w| !b.1.contains(w)), "{}: {} and {}", a.0, a.2, b.2);
            }
            assert!(!a.1.contains(&a.2), "{}: {} is a value itself", a.0, a.2);
        }
    }
}
