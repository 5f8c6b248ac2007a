//! Comparisons of the first estimator of the terms with the other results.

use crate::engine::by_matrix::Discrete;
use crate::engine::by_rays::Sampled;
use crate::stats::{Comparison, Criterion, compare, discretisation};
use crate::terms::{Functional, Series};

/// The comparison of two results.
#[derive(Clone, Debug)]
pub struct RunVerdict {
    /// The two results: `terms − path`.
    pub name: &'static str,
    /// The names of the two results in a sentence: `series`, `path tracer`.
    pub sides: [&'static str; 2],
    /// The comparison, part by part: every term, the tail, the sum, the whole.
    pub comparison: Comparison,
}

/// Compares the first estimator of the terms with the second one, the path tracer and the matrix.
pub(super) fn verdicts(terms: &[Sampled], path: Option<&Sampled>, radiosity: Option<&Discrete>) -> Vec<RunVerdict> {
    let criterion = Criterion::default();
    let judge = |name, sides, a: &Series, b: &Series, allowance: &[Functional]| {
        // terms that one estimator cannot find completely are not compared
        let comparison = match a.gap(b) {
            None => compare(a, b, &criterion, allowance),
            Some((from, _)) => compare(&a.before(from), b, &criterion, allowance),
        };
        RunVerdict { name, sides, comparison }
    };
    let Some(first) = terms.first().map(|t| &t.series) else { return vec![] };
    let other = terms
        .get(1)
        .map(|other| judge("single − prefix", ["separate paths", "shared paths"], first, &other.series, &[]));
    let path = path.map(|path| judge("terms − path", ["series", "path tracer"], first, &path.series, &[]));
    let matrix = radiosity.map(|r| {
        let (fine, coarse) = (&r.fine.series, &r.coarse.series);
        judge("terms − radiosity", ["series", "radiosity matrix"], first, fine, &discretisation(fine, coarse))
    });
    other.into_iter().chain(path).chain(matrix).collect()
}
